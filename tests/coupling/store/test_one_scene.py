"""A run's folder holds one run of one scene, whatever is done to it and whoever else writes."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import zlib
from dataclasses import fields
from pathlib import Path

import h5py
import numpy as np
import pytest
from small_scene import SMALL
from typer.testing import CliRunner

from cloth.state import Memory
from coupling.campaign.study import run_or_reuse
from coupling.cli.main import app
from coupling.scene.scene import load_scene
from coupling.simulation.energy import Instant
from coupling.store import checkpoint
from coupling.store.folder_lock import FolderError, held
from coupling.store.run_record import RunStatistics

HELD = (Memory, Instant, RunStatistics)

# Its first steps are off the rhythm of the output: 13 steps, written every fourth.
SCENE = f"""\
{SMALL}ramp = 0.0
[model]
fluid = "hydrostatic"
[cloth]
resolution = 4
tolerance = 0.001
[time]
settle = 0.3
duration = 0.13
step = 0.01
output_every = 4
checkpoint_every = 5
"""
TABLE = "time,ax,ay,az\n0,0,0,0\n0.1,1,0,0\n1,0,0,0\n"


def edt(*words: object) -> tuple[int, str]:
    """Exit status and what was printed to a person."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result.exit_code, result.stderr


def change(run: Path, old: str, new: str) -> None:
    file = run / "scene.toml"
    text = file.read_text()
    assert old in text
    file.write_text(text.replace(old, new))


@pytest.fixture(scope="module")
def original(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a run that has finished, moved by a table."""
    place = tmp_path_factory.mktemp("original")
    (place / "table.csv").write_text(TABLE)
    moved = 'kind = "table"\nfile = "table.csv"\n'
    kept = SCENE.replace('kind = "sine"\nfrequency = 2.0\namplitude = 0.002\n', moved)
    (place / "scene.toml").write_text(kept)
    assert edt("run", place, "-o", place / "run")[0] == 0
    return place / "run"


@pytest.fixture
def run(original: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return Path(shutil.copytree(original, tmp_path / "run"))


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("step = 0.01", "step = 0.005", "time.step: 0.01 -> 0.005"),
        ("radius = 0.2", "radius = 0.3", "tank.radius: 0.2 -> 0.3"),
        ("fill_fraction = 0.8", "fill_fraction = 0.7", "liquid.fill_fraction: 0.8 -> 0.7"),
        ("resolution = 4", "resolution = 5", "cloth.resolution: 4 -> 5"),
        ('"hydrostatic"', '"potential"', 'model.fluid: "hydrostatic" -> "potential"'),
        ("duration = 0.13", "duration = 0.1", "time.duration: 0.1 s is less than the 0.13 s"),
    ],
)
def test_resume_refuses_a_changed_scene(run: Path, old: str, new: str, said: str) -> None:
    """It was computed on as if it had always been so, and the results of the rest were lost."""
    before = (run / "results.h5").read_bytes()
    change(run, old, new)
    status, errors = edt("resume", run)
    assert status == 2
    assert said in errors
    assert (run / "results.h5").read_bytes() == before


def test_resume_refuses_a_changed_table(run: Path) -> None:
    (run / "motion.csv").write_text(TABLE.replace("0.1,1", "0.1,2"))
    status, errors = edt("resume", run)
    assert status == 2
    assert "motion.file: the table differs, first in line 3: '0.1,1,0,0' -> '0.1,2,0,0'" in errors


def test_resume_refuses_another_runs_checkpoint(run: Path, tmp_path: Path) -> None:
    other = tmp_path / "other"
    (tmp_path / "scene.toml").write_text(SCENE)
    assert edt("run", tmp_path, "-o", other)[0] == 0
    shutil.copy(other / "checkpoint.h5", run)
    status, errors = edt("resume", run)
    assert status == 2
    assert "motion.kind" in errors
    shutil.copy(other / "scene.toml", run)  # now the results alone are those of the first
    status, errors = edt("resume", run)
    assert status == 2
    assert "checkpoint.h5 and results.h5 are of different runs" in errors


@pytest.mark.parametrize(
    ("schema", "age"),
    [
        (1, "an older"),
        (checkpoint.SCHEMA - 1, "an older"),
        (checkpoint.SCHEMA + 1, "a newer"),
    ],
)
def test_resume_refuses_a_checkpoint_of_another_schema(run: Path, schema: int, age: str) -> None:
    with h5py.File(run / "checkpoint.h5", "r+") as file:
        file.attrs["schema"] = schema
    status, errors = edt("resume", run)
    assert status == 2
    assert f"{age} version of the program wrote it (schema {schema}" in errors


def test_what_a_checkpoint_holds_is_that_of_its_schema() -> None:
    """A name changed beneath an old number, and resuming an older run ended in a traceback.

    Who changes a name raises ``SCHEMA``, and renews both numbers here.
    """
    names = [f"{kind.__name__}.{f.name}" for kind in HELD for f in fields(kind)]
    assert (checkpoint.SCHEMA, zlib.crc32(" ".join(names).encode())) == (10, 1543478195)


def test_a_run_made_longer_is_the_one_that_never_stopped(run: Path, original: Path) -> None:
    """Bit for bit. The sample at the former end is off the rhythm of the output, and goes."""
    change(run, "duration = 0.13", "duration = 0.22")
    assert edt("resume", run)[0] == 0
    whole = run.parent / "whole"
    assert edt("run", original, "-o", whole, "--set", "time.duration=0.22")[0] == 0
    assert_equal(run, whole)
    summary = json.loads((run / "summary.json").read_text())
    assert (summary["status"], summary["steps"]) == ("completed", 22)
    with h5py.File(run / "results.h5") as file:
        assert "duration = 0.22" in file.attrs["scene"]


def assert_equal(one: Path, other: Path) -> None:
    with h5py.File(one / "results.h5") as a, h5py.File(other / "results.h5") as b:
        names: list[str] = []
        b.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
        assert "diaphragm/position" in names
        for name in names:
            assert np.array_equal(a[name][()], b[name][()], equal_nan=True), name


def test_resume_of_a_finished_run_computes_nothing(run: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in run.iterdir()}
    status, errors = edt("resume", run)
    assert status == 0
    assert "finished; nothing is left to compute" in errors
    assert {path: path.stat().st_mtime_ns for path in run.iterdir()} == before


def test_a_run_stopped_while_settling_begins_again(run: Path, original: Path) -> None:
    """Neither run nor resume took such a folder."""
    for name in ("checkpoint.h5", "summary.json", "results.h5", "report.html"):
        (run / name).unlink()
    status, errors = edt("run", original, "-o", run)
    assert status == 2
    assert f"Go on with it: edt resume {run}" in errors
    assert edt("resume", run)[0] == 0
    assert_equal(run, original)
    (run / "checkpoint.h5").unlink()  # not by a kill: its results would be lost
    status, errors = edt("resume", run)
    assert status == 2
    assert "checkpoint.h5 is missing, while results.h5 reaches 0.13 s" in errors


def test_a_run_stopped_before_its_scene_was_written_starts(original: Path, tmp_path: Path) -> None:
    folder = tmp_path / "begun"
    folder.mkdir()
    for name in ("log.txt", "motion.csv", ".scene.toml.partial", ".lock"):
        (folder / name).touch()
    status, errors = edt("resume", folder)
    assert status == 2
    assert "no run to go on with" in errors
    assert edt("run", original, "-o", folder)[0] == 0
    assert_equal(folder, original)


def test_the_users_scene_is_never_replaced(tmp_path: Path) -> None:
    """``edt run X -o X --force`` wrote all defaults into it."""
    case, other = tmp_path / "case", tmp_path / "other"
    for folder in (case, other):
        folder.mkdir()
        (folder / "scene.toml").write_text(SCENE)
    for output, said in ((case, "would replace"), (other, "holds a scene")):
        status, errors = edt("run", case, "-o", output, "--force")
        assert status == 2
        assert said in errors
        assert [path.name for path in output.iterdir()] == ["scene.toml"]
        assert (output / "scene.toml").read_text() == SCENE


def test_a_run_does_not_replace_a_study(original: Path, tmp_path: Path) -> None:
    (tmp_path / "study.json").write_text("{}")
    status, errors = edt("run", original, "-o", tmp_path, "--force")
    assert status == 2
    assert "holds a study or a sweep" in errors


HOLD = """
import subprocess, sys, time
from pathlib import Path
from coupling.store.folder_lock import held
with held(Path(sys.argv[1])):
    child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
    print(child.pid, flush=True)
    time.sleep(60)
"""


def test_a_run_that_is_alive_is_left_alone_and_a_killed_one_holds_nothing(run: Path) -> None:
    """The second process killed the first; programs that a run starts do not keep its lock."""
    change(run, "duration = 0.13", "duration = 0.15")
    before = (run / "results.h5").read_bytes()
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(run)], stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None
    child = int(holder.stdout.readline())
    try:
        scene = ("run", run.parent, "-o", run, "--force")
        (run.parent / "scene.toml").write_text(SCENE)
        for words in (("resume", run), scene):
            status, errors = edt(*words)
            assert status == 2
            assert f"process {holder.pid} on " in errors
            assert " since 20" in errors
        with pytest.raises(FolderError, match=f"process {holder.pid}"):
            run_or_reuse(load_scene(run), run, None)
        assert (run / "results.h5").read_bytes() == before
        holder.kill()
        holder.wait()
        os.kill(child, 0)  # it lives on
        assert edt("resume", run)[0] == 0
    finally:
        holder.kill()
        os.kill(child, signal.SIGKILL)
    assert not (run / ".lock").exists()


def test_force_leaves_a_study_alone_in_which_a_run_is_alive(tmp_path: Path) -> None:
    (tmp_path / "scene.toml").write_text(SCENE)
    study = tmp_path / "study"
    with held(study / "hydrostatic"):
        (study / "study.json").write_text("{}")
        status, errors = edt("study", tmp_path, "-o", study, "--force")
    assert status == 2
    assert f"process {os.getpid()}" in errors
    assert (study / "study.json").exists()


def test_a_lock_removed_by_its_holder_is_made_anew(tmp_path: Path) -> None:
    with held(tmp_path):
        (tmp_path / ".lock").unlink()
        with held(tmp_path):
            assert json.loads((tmp_path / ".lock").read_text())["pid"] == os.getpid()
            with pytest.raises(FolderError), held(tmp_path):
                pass


def test_study_and_sweep_refuse_another_plan(tmp_path: Path) -> None:
    """Finished results of other settings were replaced without a word."""
    (tmp_path / "scene.toml").write_text(SCENE)
    study = ("study", tmp_path, "--models", "datum,hydrostatic", "--quick", "-o", tmp_path / "s")
    sweep = (
        "sweep",
        tmp_path,
        "--models",
        "datum,hydrostatic",
        "-o",
        tmp_path / "w",
        "--workers",
        1,
    )
    two = ("--over", "liquid.fill_fraction=0.7,0.8")
    assert edt(*study)[0] == 0
    assert edt(*sweep, *two)[0] == 0
    runs = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("results.h5")}
    for words, said in (
        ((*study, "--set", "tank.radius=0.3"), "tank.radius: 0.2 -> 0.3 (datum"),
        ((*study[:3], "datum,potential", *study[4:]), "hydrostatic was run, and is left out now"),
        ((*sweep, *two, "--set", "time.step=0.02"), "time.step: 0.01 -> 0.02 (points/liquid."),
        ((*sweep, "--over", "liquid.fill_fraction=0.8,0.9"), "0.7/datum was run, and is left out"),
    ):
        status, errors = edt(*words)
        assert status == 2
        assert "holds runs of another plan" in errors
        assert said in errors
    for words in (study, (*sweep, *two), (*sweep, "--over", "liquid.fill_fraction=0.7,0.8,0.9")):
        assert edt(*words)[0] == 0  # goes on, also with more
    now = {path: path.stat().st_mtime_ns for path in tmp_path.rglob("results.h5")}
    assert runs.items() <= now.items()
    assert edt(*study, "--set", "tank.radius=0.3", "--force")[0] == 0
    scene = (tmp_path / "s" / "datum" / "scene.toml").read_text()
    assert "radius = 0.3" in scene
