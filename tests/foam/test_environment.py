"""Runs where paths, libraries, batch systems or a user's settings are not as OpenFOAM has them."""

import os
import shutil
from pathlib import Path

import pytest

from coupling.finite_volume.mesh import half_ball
from coupling.foam.installation import find_openfoam
from coupling.foam.keepalive import case_of
from coupling.foam.prefixes import OpenFoamMissing
from coupling.foam.rehearsal import rehearse

pytestmark = pytest.mark.openfoam

MESH = half_ball(176)
# What a batch system and a surrounding mpirun leave in the environment of a job.
JOB = {
    "SLURM_JOB_ID": "5", "SLURM_JOBID": "5", "SLURM_NODELIST": "n[1-2]", "SLURM_NNODES": "2",
    "SLURM_TASKS_PER_NODE": "4(x2)", "PBS_JOBID": "1", "PBS_ENVIRONMENT": "x", "LSB_JOBID": "1",
    "PMI_RANK": "0", "PMI_FD": "7", "PMI_SIZE": "2", "PMIX_RANK": "0", "PMIX_NAMESPACE": "x",
    "OMPI_COMM_WORLD_SIZE": "2", "OMPI_COMM_WORLD_RANK": "0", "OMPI_MCA_ess": "slurm",
    "OMPI_MCA_plm": "slurm", "OMPI_MCA_ess_base_jobid": "123", "PE_HOSTFILE": "/nonexistent",
}  # fmt: skip
# The stock solver is restarted and writes a folder a time; the others stay alive.
SOLVERS = pytest.mark.parametrize(
    ("keep_alive", "processors"), [(False, 1), (True, 1), (True, 2)], ids=["stock", "alive", "two"]
)


def step(folder, keep_alive, processors):
    """One step of a liquid at rest."""
    openfoam = find_openfoam(keep_alive=keep_alive, processors=processors)
    case = case_of(folder, MESH, openfoam=openfoam, timeout=30.0)
    try:
        case.create(MESH.points, viscosity=1e-6)
        pressure, _ = case.advance(0.0, 1e-3, MESH.points)
    finally:
        case.close()
    assert pressure.shape == (MESH.cells,)


@pytest.fixture
def fresh():
    """Nothing known of an earlier start of the solver."""
    rehearse.cache_clear()
    yield
    rehearse.cache_clear()


@SOLVERS
@pytest.mark.parametrize("name", ["a blank", "it's", 'q"q', "new\nline", "$HOME;x:y", "ä{}()*?#"])
def test_run_in_a_folder_of_any_name(alive, tmp_path, name, keep_alive, processors):
    step(tmp_path / name / "case", keep_alive, processors)


@SOLVERS
def test_temporary_folder_with_a_blank(alive, tmp_path, monkeypatch, keep_alive, processors):
    odd = tmp_path / "tem por'ary"
    odd.mkdir()
    monkeypatch.setenv("TMPDIR", str(odd))
    monkeypatch.setattr("tempfile.tempdir", None)
    step(tmp_path / "case", keep_alive, processors)


@SOLVERS
def test_variables_of_a_job_without_its_launcher(
    alive, tmp_path, monkeypatch, keep_alive, processors
):
    for name, value in JOB.items():
        monkeypatch.setenv(name, value)
    step(tmp_path / "case", keep_alive, processors)


@SOLVERS
def test_settings_of_the_user_do_not_reach_the_solver(
    alive, tmp_path, monkeypatch, keep_alive, processors
):
    (tmp_path / ".OpenFOAM").mkdir()
    (tmp_path / ".OpenFOAM" / "controlDict").write_text(
        "OptimisationSwitches { fileHandler collated; trapFpe 0; setNan 1; }\n"
    )
    monkeypatch.setenv("XDG_CACHE_HOME", str(find_openfoam(keep_alive=True).walls.parents[2]))
    monkeypatch.setenv("HOME", str(tmp_path))
    for name, value in (("FILEHANDLER", "collated"), ("SETNAN", "true"), ("SIGFPE", "false")):
        monkeypatch.setenv(f"FOAM_{name}", value)
    step(tmp_path / "case", keep_alive, processors)
    assert not list((tmp_path / "case").glob("processors*"))  # where collated fields go


def refused(edt, scene, tmp_path, monkeypatch, **environment):
    """What ``edt run`` says before anything has started."""
    for name, value in environment.items():
        monkeypatch.setenv(name, str(value))
    done = edt("run", scene, "-o", tmp_path / "run")
    assert done.returncode == 2, done.stderr
    assert not (tmp_path / "run").exists()
    assert "Halve time.step" not in done.stderr
    return done.stderr


def test_broken_libraries_first_on_the_path(edt, scene, tmp_path, monkeypatch):
    (tmp_path / "lib").mkdir()
    (tmp_path / "lib" / "libfiniteVolume.so").write_text("broken")
    said = refused(edt, scene, tmp_path, monkeypatch, LD_LIBRARY_PATH=tmp_path / "lib")
    assert "libfiniteVolume.so: file too short" in said
    assert "unset LD_LIBRARY_PATH" in said


@pytest.mark.parametrize("part", ["edtPimpleFoam", "libedtWalls.so"])
def test_solver_in_the_cache_that_was_cut(alive, edt, scene, tmp_path, monkeypatch, part):
    built = Path(alive.keep_alive).parent
    kept = tmp_path / "diaphragm-tank" / built.name
    shutil.copytree(built, kept)
    os.truncate(kept / part, 20_000)
    said = refused(edt, scene, tmp_path, monkeypatch, XDG_CACHE_HOME=tmp_path)
    assert f"{kept}/edtPimpleFoam: does not work here: " in said
    assert f"Remove {kept} and run 'edt build-solver' again." in said


def test_cache_in_a_folder_with_a_blank(alive, edt, scene, tmp_path, monkeypatch):
    kept = tmp_path / "ca che" / "diaphragm-tank"
    shutil.copytree(Path(alive.keep_alive).parent, kept / Path(alive.keep_alive).parent.name)
    said = refused(edt, scene, tmp_path, monkeypatch, XDG_CACHE_HOME=tmp_path / "ca che")
    assert "cannot run from a path with blanks" in said
    assert "Set XDG_CACHE_HOME" in said


def test_launcher_that_does_not_work(alive, fresh, tmp_path, monkeypatch):
    launcher = tmp_path / "mpirun"
    launcher.write_text("#!/bin/sh\necho 'mpirun: unable to launch'; exit 1\n")
    launcher.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
    with pytest.raises(OpenFoamMissing, match=r"unable to launch. Set openfoam.processors = 1"):
        rehearse("pimpleFoam", keep_alive=True, processors=2)


def test_temporary_folder_without_room(fresh, monkeypatch):
    def full(*_, **__):
        raise OSError(28, "No space left on device", "/tmp/edt-x")

    monkeypatch.setattr("coupling.foam.rehearsal._step", full)
    with pytest.raises(OpenFoamMissing, match=r"/tmp/edt-x: No space left.* Set TMPDIR"):
        rehearse("pimpleFoam", keep_alive=False, processors=1)
