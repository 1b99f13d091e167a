"""Building the solver that stays alive: where it goes, and what is said when it cannot be built."""

import io
import os
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

from coupling.foam import build, debian_source
from coupling.foam.build import BuildFailed, build_solver
from coupling.foam.debian_source import NoHeaders, fetch, source_package, unpack_headers
from coupling.foam.process import OpenFoam
from coupling.foam.solver_cache import (
    NAME,
    NoCache,
    built_for_any,
    built_solver,
    cache_folder,
    solver_path,
    sources,
)


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    """A cache of the test's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache" / "diaphragm-tank"


@pytest.fixture
def openfoam(tmp_path):
    """An OpenFOAM that is binaries only, as Debian's."""
    (tmp_path / "foam" / "etc").mkdir(parents=True)
    return OpenFoam(solver=Path("/bin/sh"), project_dir=tmp_path / "foam", version="1912")


def test_cache_is_where_the_user_has_it(cache, monkeypatch, tmp_path):
    assert cache_folder() == cache
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "diaphragm-tank"


def test_sources_come_with_the_package():
    found = sources()
    assert {f"{NAME}.C", "coupler.H", "Make/files", "Make/options"} <= set(found)
    assert "int main" in found[f"{NAME}.C"]


def test_solver_is_found_by_openfoam_and_source(cache, monkeypatch):
    path = solver_path("1912")
    assert path.parent.parent == cache
    assert built_solver("1912") is None
    path.parent.mkdir(parents=True)
    path.touch()
    assert built_solver("1912") is None  # not a program
    path.chmod(0o755)
    assert built_solver("1912") == path
    assert built_solver("2006") is None
    changed = sources() | {"coupler.H": "other"}
    monkeypatch.setattr("coupling.foam.solver_cache.sources", lambda: changed)
    assert built_solver("1912") is None


def test_solver_that_is_there_is_not_built_again(openfoam, monkeypatch):
    path = solver_path("1912")
    path.parent.mkdir(parents=True)
    path.touch()
    path.chmod(0o755)
    monkeypatch.setattr(build, "fetch", None)
    assert build_solver(openfoam) == path


def test_compiler_that_is_missing_is_named(openfoam, monkeypatch, tmp_path, cache):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BuildFailed, match=r"g\+\+: not on the PATH.*apt-get install g\+\+"):
        build_solver(openfoam)
    assert not any(cache.iterdir())  # nothing half done


def test_openfoam_with_sources_takes_wmake(openfoam, monkeypatch, tmp_path):
    for part in ("src", "wmake"):
        (openfoam.project_dir / part).mkdir()
    monkeypatch.delenv("FOAM_SOLVERS", raising=False)
    with pytest.raises(BuildFailed, match="Source OpenFOAM's etc/bashrc"):
        build_solver(openfoam)


def test_openfoam_of_its_own_without_sources_is_named(openfoam):
    """Debian's source package would be of another version."""
    (openfoam.project_dir / "platforms").mkdir()
    with pytest.raises(BuildFailed, match=r"foam: has no src/ and wmake/.*-dev and -source"):
        build_solver(openfoam)


def test_compiler_that_fails_is_quoted(openfoam, monkeypatch, tmp_path):
    compiler = tmp_path / "g++"
    compiler.write_text("#!/bin/sh\necho note; echo 'x.H:3: error: of the test' >&2; exit 1\n")
    compiler.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:/usr/bin:/bin")
    monkeypatch.setattr(build, "source_package", lambda _: ("openfoam", "1912.1-1"))
    monkeypatch.setattr(build, "fetch", lambda *_: tarball(tmp_path, {}))
    monkeypatch.setattr(build, "_library_folder", lambda _: Path("/usr/lib"))
    with pytest.raises(BuildFailed, match=r"exit status 1(.|\n)*error: of the test"):
        build_solver(openfoam)


def test_program_without_a_package_is_named(tmp_path):
    (tmp_path / "pimpleFoam").touch()
    with pytest.raises(NoHeaders, match=r"dpkg-query(.|\n)*wmake"):
        source_package(tmp_path / "pimpleFoam")


def tarball(folder, files):
    path = folder / "openfoam_1912.1.orig.tar.bz2"
    with tarfile.open(path, "w:bz2") as archive:
        for name, text in files.items():
            member = tarfile.TarInfo(f"openfoam-1912/{name}")
            member.size = len(text)
            archive.addfile(member, io.BytesIO(text.encode()))
    return path


def test_headers_are_laid_out_as_the_compiler_wants_them(tmp_path):
    source = tarball(tmp_path, {
        "src/finiteVolume/deep/down/fvCFD.H": "a",
        "src/finiteVolume/deep/fvMesh.C": "b",
        "src/finiteVolume/deep/fvPatchField.txx": "e",  # bodies of templates in newer versions
        "src/finiteVolume/deep/fvPatch.cxx": "no",
        "src/finiteVolume/Make/files": "no",
        "src/finiteVolumeOther/x.H": "no",
        "src/transportModels/incompressible/transportModel/transportModel.H": "c",
        "applications/solvers/incompressible/pimpleFoam/UEqn.H": "d",
        "applications/solvers/incompressible/pimpleFoam/pimpleFoam.C": "no",
        "applications/solvers/incompressible/pimpleFoam/SRFPimpleFoam/UEqn.H": "no",
    })  # fmt: skip
    into = tmp_path / "headers"
    folders = unpack_headers(source, into)
    found = {p.relative_to(into).as_posix(): p.read_text() for p in into.rglob("*") if p.is_file()}
    assert found == {
        "finiteVolume/fvCFD.H": "a",
        "finiteVolume/fvMesh.C": "b",
        "finiteVolume/fvPatchField.txx": "e",
        "transportModels/incompressible/transportModel/transportModel.H": "c",
        "solver/UEqn.H": "d",
    }
    assert into / "finiteVolume" in folders
    assert into / "transportModels" in folders


def test_broken_tarball_is_named(tmp_path):
    path = tmp_path / "openfoam.tar.bz2"
    path.write_bytes(b"rubbish")
    with pytest.raises(NoHeaders, match=r"openfoam.tar.bz2(.|\n)*Remove it"):
        unpack_headers(path, tmp_path / "headers")


def test_system_sources_are_asked_for_source_packages(tmp_path, monkeypatch):
    apt = tmp_path / "apt"
    (apt / "sources.list.d").mkdir(parents=True)
    (apt / "sources.list").write_text("# deb old\ndeb http://a/debian stable main\n")
    (apt / "sources.list.d" / "b.sources").write_text("Types: deb\nURIs: http://b\nSuites: x\n")
    (apt / "sources.list.d" / "b.save").write_text("deb no")
    monkeypatch.setattr(debian_source, "APT", apt)
    into = tmp_path / "into"
    into.mkdir()
    debian_source._write_sources(into)
    assert {p.name: p.read_text() for p in into.iterdir()} == {
        "sources.list": "# deb old\ndeb-src http://a/debian stable main\n",
        "b.sources": "Types: deb-src\nURIs: http://b\nSuites: x\n",
    }


def test_without_a_network_the_mend_is_said(tmp_path, monkeypatch, cache):
    apt = tmp_path / "apt"
    apt.mkdir()
    (apt / "sources.list").write_text("deb [trusted=yes] http://127.0.0.1:9/debian stable main\n")
    monkeypatch.setattr(debian_source, "APT", apt)
    with pytest.raises(NoHeaders) as caught:
        fetch("openfoam", "1912.1-1", lambda _: None)
    stated = str(caught.value)
    assert "Is there a network" in stated
    assert f"openfoam_1912.1.orig.tar.bz2 into {cache / 'source'}" in stated
    assert list((cache / "source").iterdir()) == []  # nothing half fetched
    (cache / "source" / "openfoam_1912.1.orig.tar.xz").touch()
    assert fetch("openfoam", "1912.1-1", lambda _: None).name == "openfoam_1912.1.orig.tar.xz"


def test_without_a_home_nothing_is_built_and_nothing_is_kept(monkeypatch):
    """A user without an entry in the list of users, and no HOME: no traceback, no folder ``~``."""

    def no_entry(uid):
        raise KeyError(uid)

    monkeypatch.delenv("HOME", raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr("pwd.getpwuid", no_entry)
    assert built_solver("1912") is None
    assert not built_for_any()
    with pytest.raises(NoCache, match="Set XDG_CACHE_HOME"):
        cache_folder()


def test_account_without_a_name_can_read_dictionaries(tmp_path):
    """PyFoam asks for it when it reads one."""
    code = (
        "import os, pwd\n"
        "for name in ('LOGNAME', 'USER', 'LNAME', 'USERNAME', 'HOME'): os.environ.pop(name, None)\n"
        "def none(uid): raise KeyError(uid)\n"
        "pwd.getpwuid = none\n"
        "from coupling.foam.pyfoam import ParsedParameterFile\n"
        "print(ParsedParameterFile('dict', noHeader=True)['nu'])\n"
    )
    (tmp_path / "dict").write_text("nu 3;\n")
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])},
    )  # fmt: skip
    assert done.stdout == "3\n", done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["dict"]


def test_settings_of_pyfoam_that_cannot_be_read(tmp_path):
    """They ended its import with a traceback."""
    (tmp_path / ".pyFoam").mkdir()
    (tmp_path / ".pyFoam" / "pyfoamrc").write_text("no [ section\n")
    (tmp_path / "dict").write_text("nu 3;\n")
    code = (
        "import os\n"
        "from coupling.foam.pyfoam import ParsedParameterFile\n"
        "print(ParsedParameterFile('dict', noHeader=True)['nu'], os.environ['HOME'])\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=60,
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3]), "HOME": str(tmp_path)},
    )  # fmt: skip
    assert done.stdout == f"3 {tmp_path}\n", done.stderr
