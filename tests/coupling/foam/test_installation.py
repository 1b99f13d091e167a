"""Finding OpenFOAM: what is missing or not allowed is named with its mend; what it runs in."""

import pytest

from coupling.foam.installation import (
    ALLOW_COMMAND,
    cause_of,
    check_installed,
    find_openfoam,
    mend_of,
)
from coupling.foam.prefixes import OpenFoamMissing
from coupling.foam.process import OpenFoam, OpenFoamFailed, clean_environment, scratch_folder


@pytest.fixture
def installed(tmp_path, monkeypatch):
    """A function that makes a solver of a shell script, and the folder that it needs."""
    (tmp_path / "etc").mkdir()
    (tmp_path / "etc" / "controlDict").touch()
    monkeypatch.setenv("WM_PROJECT_DIR", str(tmp_path))
    monkeypatch.setenv(ALLOW_COMMAND, "1")

    def make(script, name="solver"):
        program = tmp_path / name
        program.parent.mkdir(exist_ok=True)
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        return str(program)

    return make


def test_command_that_is_not_there_is_named_with_the_mend(monkeypatch):
    monkeypatch.setenv(ALLOW_COMMAND, "1")
    with pytest.raises(OpenFoamMissing, match=r"no program 'pimpleFaom'.*apt-get install"):
        find_openfoam("pimpleFaom")


def test_folder_without_etc_is_named(tmp_path, monkeypatch):
    monkeypatch.setenv(ALLOW_COMMAND, "1")
    monkeypatch.setenv("WM_PROJECT_DIR", str(tmp_path))
    with pytest.raises(OpenFoamMissing, match="no etc/controlDict below"):
        find_openfoam("sh")


@pytest.mark.parametrize(
    ("answer", "version"),
    [
        ("Using: OpenFOAM (1912) (see www.OpenFOAM.com)", "1912"),
        ("Using: OpenFOAM-v2012 (visit)", "v2012"),
        ("Build: 8-1234\\nUsing: OpenFOAM-8 (see https://openfoam.org)", "8"),
        ("nothing", "unknown"),
    ],
)
def test_version(installed, answer, version):
    assert find_openfoam(installed(f"printf '{answer}\\n'")).version == version


@pytest.mark.parametrize("find", [find_openfoam, check_installed])
def test_command_of_a_scene_is_not_started(installed, tmp_path, monkeypatch, find):
    program = installed(f"touch '{tmp_path}/started'")
    monkeypatch.delenv(ALLOW_COMMAND)
    with pytest.raises(OpenFoamMissing, match=r"openfoam\.command: must be 'pimpleFoam'.*--allow"):
        find(program, keep_alive=True, processors=1)
    assert not (tmp_path / "started").exists()


def test_looking_for_the_programs_starts_none(installed, tmp_path):
    program = installed(f"touch '{tmp_path}/started'")
    check_installed(program, keep_alive=True, processors=1)
    assert not (tmp_path / "started").exists()
    find_openfoam(program)
    assert (tmp_path / "started").exists()


def test_solver_whose_libraries_do_not_load_is_named(installed, monkeypatch):
    monkeypatch.setenv("LD_LIBRARY_PATH", "/some/other/lib")
    said = "solver: error while loading shared libraries: libOpenFOAM.so: file too short"
    program = installed(f"echo '{said}' >&2; exit 127")
    with pytest.raises(OpenFoamMissing) as caught:
        find_openfoam(program)
    assert f"{program}: does not start: {said}. " in str(caught.value)
    assert "unset LD_LIBRARY_PATH" in str(caught.value)
    assert "/some/other/lib" in str(caught.value)


@pytest.mark.parametrize("folder", ["a b", "it's", 'q"q', "a:b", "a;b", "$HOME"])
def test_path_that_openfoam_cannot_run_from_is_named(installed, folder):
    with pytest.raises(OpenFoamMissing, match="cannot run from a path with blanks, quotes"):
        find_openfoam(installed("exit 0", f"{folder}/solver"))


def test_solver_does_not_run_in_the_surroundings_of_the_user(monkeypatch):
    ours = ("SLURM_JOB_ID", "PMI_RANK", "PMIX_NAMESPACE", "OMPI_COMM_WORLD_SIZE", "PBS_JOBID",
            "OMPI_MCA_plm", "WM_PROJECT_SITE")  # fmt: skip
    for name in (*ours, "OMPI_MCA_btl", "FOAM_FILEHANDLER", "FOAM_SETNAN", "FOAM_SIGFPE"):
        monkeypatch.setenv(name, "of the user")
    found = clean_environment()
    assert not set(ours) & set(found)
    assert found["OMPI_MCA_btl"] == "of the user"
    assert found["FOAM_FILEHANDLER"] == "uncollated"
    assert found["FOAM_SETNAN"], found["FOAM_SIGFPE"] == ("false", "true")
    assert found["HOME"] == "/nonexistent"  # with .OpenFOAM/controlDict


def test_scratch_folder_is_one_that_openfoam_takes(tmp_path, monkeypatch):
    odd = tmp_path / "a blank"
    odd.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(odd))
    assert " " not in str(scratch_folder())
    monkeypatch.setattr("os.access", lambda *_: False)
    with pytest.raises(OpenFoamFailed, match=r"^TMPDIR: none of .* Set TMPDIR"):
        scratch_folder()


@pytest.mark.parametrize(
    ("output", "cause"),
    [
        ("", "it says nothing."),
        ("one\n-----\nlast word\n------\n", "last word."),
        ("Build\n--> FOAM FATAL IO ERROR: \nUnknown type x\n\nmore", "FOAM FATAL IO ERROR: Unknown"
         " type x."),
        ('Could not load "libx.so"\nlibx.so: file too short\nerror', 'Could not load "libx.so" '
         "libx.so: file too short."),
    ],
)  # fmt: skip
def test_cause_is_the_line_that_says_it(output, cause):
    assert cause_of(output) == cause


def test_mend_is_that_of_the_part_that_fails(tmp_path, monkeypatch):
    monkeypatch.delenv("LD_LIBRARY_PATH", raising=False)
    openfoam = OpenFoam(solver=tmp_path, project_dir=tmp_path, version="none", processors=2)
    assert "openfoam.processors = 1" in mend_of("mpirun: lost", openfoam)
    assert "Install OpenFOAM" in mend_of("lost")
    assert "Make room" in mend_of("No space left on device", openfoam)
