"""OpenFOAMs under the usual prefixes: found without starting any, and taken by ``--openfoam``."""

import json
import os
import shutil
from pathlib import Path

import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.foam import prefixes
from coupling.foam.installation import find_openfoam
from coupling.foam.prefixes import (
    Installation,
    OpenFoamMissing,
    advice,
    installations,
    same_version,
    take,
    version_of,
)

SOURCED = """\
export WM_PROJECT_VERSION=v{version}
[ $# -eq 0 ] || exit 3
export WM_PROJECT_DIR="$(cd "$(dirname "$BASH_SOURCE")/.." && pwd)"
export PATH="$WM_PROJECT_DIR/platforms/gcc/bin:$PATH"
export FOAM_SOLVERS="$WM_PROJECT_DIR/applications/solvers"
echo noise
unset OF_ANOTHER
"""


@pytest.fixture(autouse=True)
def surroundings(monkeypatch):
    """Take back what a test does to the environment."""
    before = dict(os.environ)
    yield
    os.environ.clear()
    os.environ.update(before)


def program(path: Path, version: str) -> None:
    path.parent.mkdir(parents=True)
    path.write_text(f"#!/bin/sh\necho 'Using: OpenFOAM-v{version} ({version})'\n")
    path.chmod(0o755)


def installed(prefix: Path, version: str, *, own: bool = True, api: bool = True) -> Path:
    """A fake OpenFOAM: with its own programs as OpenCFD's packages, or the system's as Debian's."""
    (prefix / "etc").mkdir(parents=True)
    (prefix / "etc" / "controlDict").touch()
    (prefix / "etc" / "bashrc").write_text(SOURCED.format(version=version))
    if api:
        (prefix / "META-INFO").mkdir()
        (prefix / "META-INFO" / "api-info").write_text(f"api={version}\npatch=0\n")
    if own:
        program(prefix / "platforms" / "gcc" / "bin" / "pimpleFoam", version)
    return prefix


def test_versions_come_from_the_files(tmp_path):
    assert version_of(installed(tmp_path / "a", "2312")) == "2312"
    assert version_of(installed(tmp_path / "b", "1912", api=False)) == "1912"
    assert version_of(tmp_path) == ""


def test_usual_prefixes_are_listed_by_version_and_none_is_started(tmp_path, monkeypatch):
    newer = installed(tmp_path / "lib" / "openfoam2406", "2406")
    home = installed(tmp_path / "home" / "OpenFOAM" / "OpenFOAM-v2012", "2012")
    debian = installed(tmp_path / "share" / "openfoam", "1912", own=False, api=False)
    installed(tmp_path / "lib" / "openfoam11", "11", api=False)  # of the Foundation
    (tmp_path / "lib" / "openfoam2506").mkdir()  # removed, its folder left
    (tmp_path / "lib" / "openfoam").symlink_to(newer)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setattr("subprocess.run", None)
    patterns = [f"{tmp_path}/lib/openfoam*", f"{tmp_path}/share/openfoam", "~/OpenFOAM/OpenFOAM-v*"]
    assert installations(patterns) == [
        Installation(prefix=debian, version="1912"),
        Installation(prefix=home, version="2012"),
        Installation(prefix=tmp_path / "lib" / "openfoam", version="2406"),
    ]


def test_prefix_with_programs_of_its_own_is_sourced(tmp_path, monkeypatch):
    prefix = installed(tmp_path / "with a blank" / "openfoam2312", "2312")
    monkeypatch.setenv("OF_ANOTHER", "left over")
    take(prefix)
    assert os.environ["WM_PROJECT_DIR"] == str(prefix)
    assert os.environ["FOAM_SOLVERS"] == f"{prefix}/applications/solvers"
    assert "OF_ANOTHER" not in os.environ
    assert shutil.which("pimpleFoam") == str(prefix / "platforms/gcc/bin/pimpleFoam")


def test_chosen_one_is_what_a_run_takes(tmp_path):
    prefix = installed(tmp_path / "openfoam2312", "2312")
    take(prefix)
    openfoam = find_openfoam()
    assert openfoam.version == "v2312"
    assert openfoam.project_dir == prefix
    assert openfoam.environment["WM_PROJECT_DIR"] == str(prefix)


def test_system_s_own_is_taken_in_place_of_one_sourced_before(tmp_path, monkeypatch):
    debian = installed(tmp_path / "share" / "openfoam", "1912", own=False)
    program(tmp_path / "usr" / "pimpleFoam", "1912")
    monkeypatch.setenv("PATH", f"{tmp_path}/usr:{os.environ['PATH']}")
    take(installed(tmp_path / "openfoam2312", "2312"))
    assert "openfoam2312" in str(shutil.which("pimpleFoam"))
    take(debian)
    assert shutil.which("pimpleFoam") == str(tmp_path / "usr" / "pimpleFoam")
    assert os.environ["WM_PROJECT_DIR"] == str(debian)


def test_folder_that_is_none_is_refused_with_those_found(tmp_path, monkeypatch):
    found = installed(tmp_path / "openfoam2312", "2312")
    monkeypatch.setattr(prefixes, "installations", lambda: installations([str(found)]))
    before = dict(os.environ)
    with pytest.raises(OpenFoamMissing, match=r"no etc/controlDict.*2312 in .*openfoam2312"):
        take(tmp_path)
    assert os.environ == before


def test_prefix_that_is_not_compiled_is_refused(tmp_path):
    prefix = installed(tmp_path / "openfoam2312", "2312")
    (prefix / "platforms" / "gcc" / "bin" / "pimpleFoam").unlink()
    with pytest.raises(OpenFoamMissing, match="puts no pimpleFoam of its own on the PATH"):
        take(prefix)


def test_bashrc_that_fails_is_named(tmp_path):
    prefix = installed(tmp_path / "openfoam2312", "2312")
    (prefix / "etc" / "bashrc").write_text("exit 7\n")
    with pytest.raises(OpenFoamMissing, match=r"etc/bashrc: cannot be sourced.* 7"):
        take(prefix)


def test_missing_program_names_what_could_be_chosen(tmp_path, monkeypatch):
    found = installed(tmp_path / "openfoam2312", "2312")
    monkeypatch.setattr(prefixes, "installations", lambda: installations([str(found)]))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OpenFoamMissing, match=r"no program 'pimpleFoam'.*--openfoam PREFIX.*2312"):
        find_openfoam()
    assert advice("1912") == ""


def test_command_takes_the_prefix(tmp_path):
    """``edt info`` starts the solver of the prefix; a prefix without one ends with status 2."""
    prefix = installed(tmp_path / "openfoam2312", "2312")
    done = CliRunner().invoke(app, ["info", "--json", "--openfoam", str(prefix)])
    assert done.exit_code == 0
    assert json.loads(done.stdout)["openfoam"] == f"v2312, {prefix}/platforms/gcc/bin/pimpleFoam"
    assert CliRunner().invoke(app, ["info", "--openfoam", str(tmp_path)]).exit_code == 2


def test_versions_are_the_same_with_and_without_their_letter():
    assert same_version("1912", "v1912")
    assert not same_version("1912", "v2312")
