"""A run killed without warning goes on from its checkpoint as if it had never stopped."""

import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest
from conftest import EDT

pytestmark = pytest.mark.openfoam

# The checkpoint holds both sides' states and OpenFOAM's own files bit for bit, and every solver is
# deterministic: on one machine the resumed run is the unbroken one, bit for bit.
TOLERANCE = 0.0
# Residuals of 1e-11 times the condition of a pressure matrix of a few hundred cells, some 1e3, over
# the ten steps of the run.
SOLVER_TOLERANCE = 1e-7


# Four times the scene's own, which moves the sheet by 5e-4 R in the 60 ms of the run, as an
# inviscid liquid does: too little to tell a run that goes on from one that stands.
MOTION = "motion.amplitude=0.2"
WAYS = {
    "alive": ("openfoam.keep_alive=true",),
    "two processors": ("openfoam.processors=2",),
    "restart": ("openfoam.keep_alive=false",),
}


@pytest.fixture(scope="module", params=WAYS)
def way(request: pytest.FixtureRequest) -> list[str]:
    """Options of a run whose solver works in this way."""
    if request.param != "restart":
        request.getfixturevalue("alive")
    changes = (*WAYS[request.param], MOTION)
    return [word for change in changes for word in ("--set", change)]


@pytest.fixture(scope="module")
def whole(edt, scene: Path, way: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run in this way that was not killed."""
    folder = tmp_path_factory.mktemp("whole") / "run"
    done = edt("run", scene, "-o", folder, *way)
    assert done.returncode == 0, done.stderr
    solver = json.loads((folder / "summary.json").read_text())["solver"]
    assert solver == ("restart" if "openfoam.keep_alive=false" in way else "keep-alive")
    assert solver in (folder / "log.txt").read_text()
    return folder


@pytest.fixture(scope="module")
def killed(scene: Path, way: list[str], tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run that was killed some steps after its first checkpoint."""
    folder = tmp_path_factory.mktemp("killed") / "run"
    process = subprocess.Popen(
        [*EDT, "run", str(scene), "-o", str(folder), *way],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    log, until = folder / "coupling.csv", time.monotonic() + 120
    while time.monotonic() < until and process.poll() is None:
        if log.exists() and any(line.startswith("0.03") for line in log.read_text().splitlines()):
            break
        time.sleep(0.02)
    os.kill(process.pid, signal.SIGKILL)
    assert process.wait(10) == -signal.SIGKILL
    return folder


def test_results_of_a_killed_run_open(killed):
    with h5py.File(killed / "results.h5") as file:
        count = len(file["time"])
        assert count >= 1
        assert all(len(file[name]) == count for name in ("liquid/cg", "diaphragm/position"))
    with meshio.xdmf.TimeSeriesReader(str(killed / "results.xdmf")) as reader:
        reader.read_points_cells()
        # results.h5 is written first: a kill in between leaves its last instants without a name
        assert 1 <= reader.num_steps <= count
        for step in range(reader.num_steps):
            reader.read_data(step)


@pytest.mark.parametrize("way", ["alive", "restart"], indirect=True)
def test_other_way_can_go_on(edt, killed, whole, tmp_path):
    # Both read and write the same files; between them stand the linear solvers' tolerances only.
    folder = tmp_path / "run"
    shutil.copytree(killed, folder)
    scene = (folder / "scene.toml").read_text()
    this, other = ("true", "false") if "keep_alive = true" in scene else ("false", "true")
    (folder / "scene.toml").write_text(scene.replace(f"alive = {this}", f"alive = {other}"))
    done = edt("resume", folder)
    assert done.returncode == 0, done.stderr
    with h5py.File(folder / "results.h5") as one, h5py.File(whole / "results.h5") as two:
        for name in ("diaphragm/position", "diaphragm/dynamic_pressure", "liquid/force"):
            a, b = one[name][:], two[name][:]
            assert np.abs(a - b).max() <= SOLVER_TOLERANCE * np.abs(b).max(), name


def test_resumed_run_equals_the_unbroken_one(edt, killed, whole):
    done = edt("resume", killed)
    assert done.returncode == 0, done.stderr
    summary = json.loads((killed / "summary.json").read_text())
    assert summary["status"] == "completed"
    assert summary["steps"] == 12
    with h5py.File(killed / "results.h5") as one, h5py.File(whole / "results.h5") as two:
        assert one["time"][:].tolist() == two["time"][:].tolist()
        assert one["coupling/iterations"][:].tolist() == two["coupling/iterations"][:].tolist()
        for name in ("diaphragm/position", "diaphragm/dynamic_pressure", "liquid/force"):
            a, b = one[name][:], two[name][:]
            assert np.abs(a - b).max() <= TOLERANCE * np.abs(b).max(), name
            assert np.abs(b[-1] - b[0]).max() > 1e-3 * np.abs(b).max()
    lines = (killed / "coupling.csv").read_text().splitlines()[1:]
    times = [float(line.split(",")[0]) for line in lines]
    assert times == sorted(times)
