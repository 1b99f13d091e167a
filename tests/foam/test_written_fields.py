"""The flow's fields at the times of output, if they are asked for."""

import shutil
import subprocess

import numpy as np
import pytest

from coupling.fluids.openfoam.model import OPENFOAM
from coupling.foam.case import Case
from coupling.foam.fields import read_cells
from coupling.scene.scene import load_scene
from coupling.simulation.driver import resume, run
from coupling.store.pace import Pace
from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam

FIELDS = ("openfoam.write_fields=true", "time.output_every=2", "time.checkpoint_every=3")
CELLS = 176


def times(folder):
    """Names of the times after the start that the case holds."""
    return {path.name for path in folder.iterdir() if path.name[0].isdigit()} - {"0", "0.orig"}


def named(folder):
    """Names of the times of output after the start."""
    return {Case.time_name(time) for time in read_results(folder).time[1:]}


@pytest.mark.parametrize("keep_alive", [True, False])
def test_fields_stand_at_the_times_of_output_also_after_resume(
    scene, alive, tmp_path, keep_alive, monkeypatch
):
    # A slow machine would take a checkpoint in between, which keeps all of its time.
    monkeypatch.setattr(Pace, "due", False)
    chosen = (*FIELDS, f"openfoam.keep_alive={str(keep_alive).lower()}")
    whole, parted = tmp_path / "whole", tmp_path / "parted"
    summary = run(load_scene(scene, chosen), whole)
    foam = whole / "foam"
    assert named(whole) == {"0.01", "0.02", "0.03", "0.04", "0.05", "0.06"}
    assert times(foam) == named(whole) | {"0.015", "0.045"}  # of checkpoints
    assert {path.name for path in (foam / "0.01").rglob("*") if path.is_file()} == {
        "U", "p", "points",
    }  # fmt: skip
    speeds = [np.linalg.norm(read_cells(foam / t / "U", CELLS), axis=1).max() for t in named(whole)]
    recorded = read_results(whole).metrics["speed_max"][1:]
    assert sorted(speeds) == pytest.approx(sorted(recorded))
    files = [path for name in times(foam) for path in (foam / name).rglob("*") if path.is_file()]
    assert summary["flow_fields_bytes"] == sum(path.stat().st_size for path in files)
    # what a checkpoint keeps besides, and heads of a kilobyte, are not estimated
    thin = [path for path in files if path.parts[len(foam.parts)] in ("0.01", "0.02", "0.04")]
    estimate = 3 / 6 * OPENFOAM.fields_size(load_scene(scene, chosen))
    assert 0.0 < sum(path.stat().st_size for path in thin) - estimate < 3 * 3 * 1500
    # OpenFOAM's own reader, as ParaView's, takes the points of every time
    done = subprocess.run(
        ["foamToVTK", "-case", ".", "-ascii"], cwd=foam, capture_output=True, text=True,
        env=alive.environment,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert len(list((foam / "VTK").glob("*_*"))) >= len(times(foam))

    run(load_scene(scene, (*chosen, "time.duration=0.035")), parted)  # ends beyond a checkpoint
    text = (parted / "scene.toml").read_text()
    (parted / "scene.toml").write_text(text.replace("duration = 0.035", "duration = 0.06"))
    resume(parted)
    assert named(parted) <= times(parted / "foam")
    for name in named(whole):
        for field in ("U", "p", "polyMesh/points"):
            one, other = (folder / "foam" / name / field for folder in (whole, parted))
            assert one.read_bytes() == other.read_bytes(), (name, field)
    shutil.rmtree(foam / "VTK")


def test_fields_are_not_kept_unless_asked_for(scene, tmp_path, monkeypatch):
    folder = tmp_path / "run"
    # On a machine that is slow enough a checkpoint is due by wall time, which keeps its own.
    monkeypatch.setattr("coupling.simulation.driver._CHECKPOINT_SHARE", 1e-9)
    run(load_scene(scene, ("time.output_every=2", "time.checkpoint_every=100")), folder)
    assert times(folder / "foam") == {"0.06"}  # where a longer run would go on
