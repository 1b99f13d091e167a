"""Sweeps of short real runs: rows, restarts, failures, and workers and commands that are killed."""

from __future__ import annotations

import csv
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import dask
import psutil
import pytest
from small_scene import SMALL
from typer.testing import CliRunner

from coupling.campaign.study import run_or_reuse
from coupling.campaign.sweep import run_sweep
from coupling.campaign.sweep_plan import Plan, SweepError, parse_axis, plan_sweep
from coupling.campaign.sweep_workers import local_workers, outcome_of
from coupling.cli.main import app
from coupling.scene.scene import load_scene
from coupling.store.run_record import read_summary

SCENE = f"""\
{SMALL}ramp = 0.0
[cloth]
resolution = 5
tolerance = 0.001
[time]
settle = 0.3
periods = 1
steps_per_period = 20
output_every = 2
checkpoint_every = 5
"""
MODELS = ("hydrostatic", "potential")
LONGER = ("--set", "time.periods=6")  # a run of a second, to be stopped in the middle


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def plan(path: Path, over: str, models: tuple[str, ...] = MODELS, *changes: str) -> Plan:
    return plan_sweep(path, changes, [parse_axis(over)], models)


def written(folder: Path) -> dict[Path, int]:
    """When the results of each completed run were last written."""
    return {
        file.parent: (file.parent / "results.h5").stat().st_mtime_ns
        for file in folder.glob("points/*/*/summary.json")
        if read_summary(file.parent)["status"] == "completed"
    }


def test_rows_files_and_a_restart_that_repeats_nothing(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    said: list[tuple[str, float, float, str]] = []
    content = run_sweep(
        plan(path, "motion.frequency=1,2"),
        folder,
        workers=1,
        progress=lambda *what: said.append(what),
    )
    assert [what[1] for what in said] == [0, 1, 2, 3, 4]
    assert json.loads((folder / "sweep.json").read_text()) == content
    assert [row["values"]["motion.frequency"] for row in content["rows"]] == [1, 2]
    for row in content["rows"]:
        assert row["reference"] == "potential"
        assert row["failure"] is None
        f1 = row["numbers"]["slosh_frequency"]
        assert row["numbers"]["frequency_ratio"] == row["values"]["motion.frequency"] / f1
        assert row["models"]["potential"]["error"]["cg_amplitude"] == 0.0
        assert row["models"]["hydrostatic"]["error"]["cg_amplitude"] > 0.0
        moved = {name: model["cg"]["amplitude_m"] for name, model in row["models"].items()}
        alone = read_summary(folder / "points" / row["point"] / "hydrostatic")
        assert moved["hydrostatic"] == alone["cg"]["amplitude_m"] != moved["potential"]
    with (folder / "sweep.csv").open() as file:
        (_, second) = csv.DictReader(file)
    error = content["rows"][1]["models"]["hydrostatic"]["error"]["shape_rms"]
    assert float(second["hydrostatic.error.shape_rms"]) == error
    rubs = content["rows"][1]["models"]["hydrostatic"]["rubs"]
    polar, azimuth = rubs["shell_slip_place_deg"]
    assert float(second["hydrostatic.shell_slip_max_m"]) == rubs["shell_slip_max_m"] > 0.0
    assert float(second["hydrostatic.shell_slip_place_deg.polar"]) == polar
    assert float(second["hydrostatic.shell_slip_place_deg.azimuth"]) == azimuth
    assert second["hydrostatic.shell_wear_max_m.least"] == ""
    assert (folder / "report.html").is_file()

    before = written(folder)
    assert run_sweep(plan(path, "motion.frequency=1,2"), folder) == content
    assert written(folder) == before
    more = run_sweep(plan(path, "motion.frequency=1,2,3"), folder, workers=1)
    assert more["rows"][:2] == content["rows"]
    assert len(written(folder)) == 6
    assert before.items() <= written(folder).items()


def test_a_run_in_a_worker_is_that_of_the_command(path: Path, tmp_path: Path) -> None:
    """Bit for bit but for the wall times; also where another scene stood in its folder."""
    folder, over = tmp_path / "sweep", "motion.frequency=1,2"
    place = folder / "points" / "motion.frequency_2" / "hydrostatic"
    run_or_reuse(load_scene(path, ["model.fluid=hydrostatic", "tank.radius=0.3"]), place, None)
    run_sweep(plan(path, over), folder, workers=1)
    (tmp_path / "alone").mkdir()
    alone = run_or_reuse(load_scene(path, ["model.fluid=hydrostatic"]), tmp_path / "alone", None)
    known = read_summary(place)
    for name in ("cg", "force", "strain_tensile_max", "steps"):
        assert known[name] == alone[name]


def test_a_model_that_fails_is_a_row_with_its_reason(path: Path, tmp_path: Path) -> None:
    """The flow solver is not there: errors are then against the best that completed."""
    models = ("datum", "hydrostatic", "openfoam")
    broken = plan(path, "motion.amplitude=0.001,0.002", models, "openfoam.command=/no/solver")
    content = run_sweep(broken, tmp_path / "sweep", workers=1)
    for row in content["rows"]:
        assert "/no/solver" in row["failure"]
        assert row["models"]["openfoam"]["status"] == "failed"
        assert row["models"]["openfoam"]["error"] == {}
        assert row["reference"] == "hydrostatic"
        assert row["models"]["datum"]["error"]["shape_rms"] > 0.0
    page = (tmp_path / "sweep" / "report.html").read_text()
    assert "2 of 2 points have a model that failed." in page


def test_a_run_that_kills_its_worker_each_time_is_a_failure() -> None:
    # no second try, as each takes seconds; how many there are is Dask's affair
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), local_workers(1) as client:
        future = client.submit(lambda: os.kill(os.getpid(), signal.SIGKILL))
        assert outcome_of(future)["error"].startswith("the worker process died each time")
        assert client.submit(lambda: 7).result() == 7  # another worker stands in


def test_a_cluster_by_its_address_does_the_same(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    two = plan(path, "motion.frequency=1,2")
    with local_workers(1) as client:
        address = client.cluster.scheduler_address
        content = run_sweep(two, tmp_path / "sweep", scheduler=address)
        assert client.submit(lambda: 7).result() == 7  # the cluster is left as it was
    assert [row["failure"] for row in content["rows"]] == [None, None]
    assert len(written(tmp_path / "sweep")) == 4
    monkeypatch.setattr("coupling.campaign.sweep_workers._ANSWER", 0.5)
    with pytest.raises(SweepError, match=r"--scheduler tcp://127\.0\.0\.1:9: no answer"):
        run_sweep(two, tmp_path / "other", scheduler="tcp://127.0.0.1:9")


@contextmanager
def command(path: Path, folder: Path, workers: int = 1) -> Iterator[subprocess.Popen[str]]:
    """``edt sweep`` over three points in a session of its own."""
    words = ["sweep", path, "--over", "motion.frequency=1:3:3", *LONGER, "-o", folder]
    process = subprocess.Popen(
        [sys.executable, "-m", "coupling.cli", *map(str, words), "--workers", str(workers)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def wait_for(condition: object, process: subprocess.Popen[str], seconds: float = 600.0) -> None:
    end = time.monotonic() + seconds
    while not condition():  # type: ignore[operator]
        assert process.poll() is None, process.stdout and process.stdout.read()
        assert time.monotonic() < end
        time.sleep(0.02)


def workers_of(process: subprocess.Popen[str]) -> list[psutil.Process]:
    children = psutil.Process(process.pid).children(recursive=True)
    return [child for child in children if any("spawn_main" in word for word in child.cmdline())]


def running(folder: Path) -> bool:
    """Whether some run is between its first checkpoint and its end."""
    return any(
        not (file.parent / "summary.json").is_file()
        for file in folder.glob("points/*/*/checkpoint.h5")
    )


def assert_complete(folder: Path) -> None:
    rows = json.loads((folder / "sweep.json").read_text())["rows"]
    assert [row["values"]["motion.frequency"] for row in rows] == [1, 2, 3]
    assert [row["failure"] for row in rows] == [None] * 3


def test_a_worker_killed_in_a_run_is_survived(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    with command(path, folder, workers=2) as process:
        wait_for(lambda: written(folder) and running(folder), process)
        killed = workers_of(process)
        assert len(killed) == 2
        for worker in killed:
            worker.kill()
        before = written(folder)
        output, _ = process.communicate(timeout=600)
        assert process.returncode == 0, output
    assert_complete(folder)
    assert before.items() <= written(folder).items()


def test_a_sweep_goes_on_after_ctrl_c_and_after_a_kill(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"
    with command(path, folder) as process:
        wait_for(lambda: written(folder) and running(folder), process)
        workers = workers_of(process)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does: every process gets it
        output, _ = process.communicate(timeout=300)
        assert process.returncode == 130, output
        assert "Go on with: edt sweep" in output
        assert "Traceback" not in output
    assert not psutil.wait_procs(workers, timeout=60)[1]
    before = written(folder)
    assert 1 <= len(before) < 6

    with command(path, folder) as process:
        wait_for(lambda: len(written(folder)) > len(before) and running(folder), process)
        workers = workers_of(process)
        process.kill()
    assert not psutil.wait_procs(workers, timeout=60)[1]
    later = written(folder)
    assert before.items() <= later.items()
    assert len(later) < 6

    with command(path, folder) as process:
        output, _ = process.communicate(timeout=600)
        assert process.returncode == 0, output
    assert_complete(folder)
    assert later.items() <= written(folder).items()


def test_wrong_inputs_start_nothing(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "sweep"

    def refused(*words: str) -> str:
        result = CliRunner().invoke(app, ["sweep", str(path), "-o", str(folder), *words])
        assert result.exit_code == 2
        assert not folder.exists()
        return result.output

    over = ("--over", "liquid.fill_fraction=0.5:1.5:3")
    assert "must lie in (0, 1), got 1.5" in refused(*over)
    assert "must name a key and its values" in refused("--over", "liquid.fill_fraction")
    assert "'--over'" in refused()
    good = ("--over", "liquid.fill_fraction=0.5,0.6")
    assert "two or more different ones" in refused(*good, "--models", "potential")
    assert "--workers" in refused(*good, "--workers", "0")
    found = ("--models", "hydrostatic,openfoam", "--set", "openfoam.command=/no/solver")
    assert "/no/solver" in refused(*good, *found)


def test_a_later_point_without_its_solver_starts_nothing(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first point's solver is there: a program, and OpenFOAM's folder about it."""
    (tmp_path / "etc").mkdir()
    (tmp_path / "etc" / "controlDict").touch()
    monkeypatch.setenv("WM_PROJECT_DIR", str(tmp_path))
    monkeypatch.setenv("EDT_ALLOW_COMMAND", "1")
    monkeypatch.setattr("coupling.foam.rehearsal._step", lambda *_: "")  # it is no flow solver
    folder = tmp_path / "sweep"
    (tmp_path / "python").symlink_to(sys.executable)
    over = f"openfoam.command={tmp_path}/python,/no/solver"
    words = [path, "--over", over, "--models", "hydrostatic,openfoam", "-o", folder]
    result = CliRunner().invoke(app, ["sweep", *map(str, words)])
    assert "no program '/no/solver'" in " ".join(result.output.split())
    assert result.exit_code == 2
    assert not folder.exists()


def test_no_verb_but_a_sweep_that_runs_imports_dask() -> None:
    code = (
        "import sys, coupling.cli.main, coupling.simulation.driver;"
        "import coupling.campaign.study, coupling.campaign.sweep;"
        "print([name for name in sys.modules if name.split('.')[0] in ('dask', 'distributed')])"
    )
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "[]"


def test_settings_of_dask_that_cannot_be_read_are_named(path: Path, tmp_path: Path) -> None:
    """They ended the sweep with a traceback."""
    settings = tmp_path / "dask.yaml"
    settings.write_text("a: [b")
    words = [path, "--over", "motion.frequency=1,2", "--models", "datum,hydrostatic"]
    code = "from coupling.cli.main import main; main()"
    done = subprocess.run(
        [sys.executable, "-c", code, "sweep", *map(str, words), "-o", str(tmp_path / "sweep")],
        env=os.environ | {"DASK_CONFIG": str(settings)}, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 2, done.stderr
    assert f"A dask config file at '{settings}' is malformed" in done.stderr
    assert "Traceback" not in done.stderr
