"""The command: what each verb prints, where it writes, what its exit status says."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace

import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.ports import RunFailed
from coupling.verify import CASES, case_options, option_pairs, run_case

SCENE = """\
title = "Half full"
[tank]
radius = 0.4445
[diaphragm]
thickness = 0.001778
material = "AF-E-332"
[liquid]
name = "water"
fill_fraction = 0.5
[motion]
kind = "sine"
frequency = 0.2
amplitude = 0.1
[model]
fluid = "hydrostatic"
[time]
duration = 0.5
"""

SUMMARY = {
    "status": "completed",
    "model": "hydrostatic",
    "steps": 100,
    "simulated_s": 0.5,
    "wall_s": 1.25,
    "strain_tensile_max": 0.0042,
    "volume_error_max": 1e-7,
    "coupling": {"iterations_mean": 1.5, "iterations_max": 3, "unconverged_steps": 0},
    "cg": {"amplitude_m": [0.0123, 0.0, 0.001], "phase_deg": [180.0, None, 0.0]},
    "bernoulli": {"kinetic_ratio": None, "unsteady_ratio": float("nan")},
}


@pytest.fixture
def case(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A scene's folder, below the working directory."""
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "half_full"
    folder.mkdir()
    (folder / "scene.toml").write_text(SCENE)
    return folder


@pytest.fixture
def driver(monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
    """In place of the driver: notes its calls, and reports some progress."""
    calls = []

    def run(scene, folder, *, progress=None):
        calls.append((scene, folder))
        progress("shaking", 0.25, 0.5, "2 iterations")
        progress("shaking", 0.5, 0.5, "2 iterations")
        (folder / "checkpoint.h5").touch()
        (folder / "scene.toml").touch()
        return SUMMARY

    def resume(folder, *, progress=None):
        return run(None, folder, progress=progress)

    fake = SimpleNamespace(run=run, resume=resume, calls=calls)
    monkeypatch.setitem(sys.modules, "coupling.simulation.driver", fake)
    return fake


def edt(*arguments: object):
    result = CliRunner().invoke(app, [str(argument) for argument in arguments])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result


def test_run_writes_below_runs_and_prints_the_main_figures(case: Path, driver):
    result = edt("run", "half_full")
    assert result.exit_code == 0
    scene, folder = driver.calls[0]
    assert folder == Path("runs/half_full")
    assert folder.is_dir()
    assert scene.title == "Half full"
    for text in ("completed", "0.0042", "0.0123, 0, 0.001", "180, -, 0", "1.25"):
        assert text in result.stdout
    assert "shaking: 0.500 / 0.500 s 2 iterations" in result.stderr


def test_run_takes_a_file_changes_and_a_folder_and_prints_json(case: Path, driver):
    file = (case / "scene.toml").rename(case / "slow.toml")
    result = edt("run", file, "--set", "tank.radius=0.5", "-o", "out/here", "--json")
    assert result.exit_code == 0
    assert json.loads(result.stdout)["bernoulli"]["unsteady_ratio"] is None  # JSON knows no NaN
    scene, folder = driver.calls[0]
    assert (scene.tank.radius, folder) == (0.5, Path("out/here"))
    edt("run", file)
    assert driver.calls[1][1] == Path("runs/slow")


def test_a_run_is_not_overwritten_unless_asked_for(case: Path, driver):
    edt("run", case, "-o", "out")
    again = edt("run", case, "-o", "out")
    assert again.exit_code == 2
    assert "out: holds a run. Go on with it: edt resume out; or replace it: --force" in again.stderr
    assert len(driver.calls) == 1
    Path("out/mine.txt").touch()
    Path("out/results.h5").touch()
    assert edt("run", case, "-o", "out", "--force").exit_code == 0
    assert Path("out/mine.txt").exists()
    assert not Path("out/results.h5").exists()


def test_force_touches_nothing_in_a_folder_that_holds_no_run(case: Path, driver):
    foreign = Path("mine/foam")
    foreign.mkdir(parents=True)
    assert edt("run", case, "-o", "mine").exit_code == 2
    assert edt("run", case, "-o", "mine", "--force").exit_code == 0
    assert foreign.is_dir()


def test_resume_goes_on_in_the_folder(case: Path, driver):
    (case / "log.txt").touch()
    assert edt("resume", case).exit_code == 0
    assert driver.calls == [(None, case)]


def test_a_failed_run_exits_1_with_its_reason(case: Path, driver):
    reason = "t = 0.132 s: the coupling left a relative residual of 3.1e-02. Halve time.step."

    def fail(scene, folder, *, progress=None):
        raise RunFailed(reason)

    driver.run = fail
    result = edt("run", case)
    assert (result.exit_code, result.stderr.strip()) == (1, reason)
    driver.run = lambda scene, folder, progress: SUMMARY | {"status": "failed", "error": reason}
    result = edt("run", case, "-o", "other")
    assert result.exit_code == 1
    assert result.stderr.strip() == reason


def test_a_full_disk_exits_1_without_a_traceback(case: Path, driver):
    def fail(scene, folder, *, progress=None):
        raise OSError(28, "No space left on device", "results.h5")

    driver.run = fail
    result = edt("run", case)
    assert (result.exit_code, result.stderr.strip()) == (1, "results.h5: No space left on device")


def test_an_interrupted_run_exits_130_and_says_how_to_go_on(case: Path, driver):
    def interrupted(scene, folder, *, progress=None):
        (folder / "checkpoint.h5").touch()
        raise KeyboardInterrupt

    driver.run = interrupted
    result = edt("run", case, "-o", "out")
    assert result.exit_code == 130
    assert "Go on with: edt resume out" in result.stderr


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_signals_end_a_run_with_130(case: Path, number: signal.Signals):
    program = """
import sys, time, types
def run(scene, folder, *, progress=None):
    print("started", flush=True)
    time.sleep(60)
sys.modules["coupling.simulation.driver"] = types.SimpleNamespace(run=run)
from coupling.cli.main import main
sys.argv = ["edt", "run", "half_full"]
main()
"""
    root = Path(__file__).parents[3]
    process = subprocess.Popen(
        [sys.executable, "-c", program],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(root)},
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "started\n"
    time.sleep(0.1)
    process.send_signal(number)
    _, errors = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "interrupted" in errors
    assert "Traceback" not in errors


def test_study_runs_the_models_and_prints_speed_against_error(case: Path, monkeypatch):
    calls = []
    outcome = {
        "reference": "hydrostatic",
        "models": {
            "datum": {"wall_s": 1.0, "error": {"cg_amplitude": 0.12}, "speedup": 2.0},
            "hydrostatic": {"wall_s": 2.0, "error": {"cg_amplitude": 0.0}, "speedup": 1.0},
        },
        "uncertainty": {"cg_amplitude": 0.034},
        "points": [
            {
                "model": "datum",
                "resolution": "coarser_grid",
                "wall_s": 0.5,
                "error": {"cg_amplitude": 0.23},
                "on_front": ["cg_amplitude"],
            }
        ],
        "verdict": "hydrostatics is the best there is",
        "advice": "hydrostatic will do",
    }

    def run_study(scene, models, folder, *, quick, progress=None):
        calls.append((tuple(models), folder, quick))
        (folder / "study.json").touch()
        (folder / "datum").mkdir(exist_ok=True)
        return outcome

    monkeypatch.setitem(
        sys.modules, "coupling.campaign.study", SimpleNamespace(run_study=run_study)
    )
    result = edt("study", case, "--models", "datum,hydrostatic")
    assert result.exit_code == 0
    assert calls == [(("datum", "hydrostatic"), Path("runs/half_full-study"), False)]
    assert "0.12" in result.stdout
    assert "± 0.034" in result.stdout
    assert "datum, coarser grid" in result.stdout
    assert "0.23 *" in result.stdout
    assert "hydrostatics is the best there is" in result.stdout
    assert "hydrostatic will do" in result.stdout
    # a study goes on
    again = edt("study", case, "--models", "datum,hydrostatic", "--quick", "--json")
    assert json.loads(again.stdout) == outcome
    assert calls[-1][-1] is True
    Path("runs/half_full-study/other").touch()
    assert edt("study", case, "--models", "datum,hydrostatic").exit_code == 2


def test_report_prints_where_it_is(case: Path, monkeypatch):
    report = SimpleNamespace(write_report=lambda folder: folder / "report.html")
    monkeypatch.setitem(sys.modules, "coupling.report", report)
    (case / "results.h5").touch()
    result = edt("report", case)
    assert (result.exit_code, result.stdout.strip()) == (0, str(case / "report.html"))


def test_a_run_leaves_its_report_and_gives_its_picture(case: Path):
    changes = ["--set", "time.duration=0.02", "--set", "model.fluid=hydrostatic"]
    assert edt("run", case, "-o", "run", *changes, "--set", "cloth.resolution=4").exit_code == 0
    assert Path("run/report.html").is_file()
    assert edt("render", "run", "-o", "run.svg").exit_code == 0
    assert Path("run.svg").read_text().lstrip().startswith("<?xml")
    assert edt("render", "run").stdout.strip() == "run/period.mp4"
    assert Path("run/period.mp4").stat().st_size > 1000
    assert edt("render", "run", "-o", "run.doc").exit_code == 2
    assert edt("run", case, "-o", "run", *changes, "--force").exit_code == 0
    assert not Path("run/period.mp4").exists()  # of the run that was replaced


def test_a_study_is_no_run_to_render(case: Path):
    (case / "study.json").touch()
    result = edt("render", case)
    assert result.exit_code == 2
    assert "is no run" in result.stderr


def test_check_advises_a_model(case: Path):
    slower = ("--set", "motion.frequency=0.1", "--set", "motion.acceleration=0.5")
    result = edt("check", case, *slower)
    assert result.exit_code == 0
    assert "advised: hydrostatic" in result.stdout
    assert json.loads(edt("check", case, *slower, "--json").stdout)["advised"] == "hydrostatic"
    # 10 % by the rule, where 5 % is allowed
    faster = edt("check", case, "--set", "motion.frequency=0.3", "--json")
    assert json.loads(faster.stdout)["advised"] == "potential"
    values = json.loads(edt("check", case, "--json").stdout)
    cover = 1.560157 * 1070 * 0.001778 / (997 * 0.4445)  # the diaphragm's mass on the level
    error = (0.2 / 0.9339) ** 2 * (1.0 + cover)
    assert values["numbers"]["hydrostatic_error"] == pytest.approx(error, rel=1e-3)
    hydrostatic = values["models"]["hydrostatic"]
    assert hydrostatic["expected"] < hydrostatic["upper"]
    assert 0.5 * error < hydrostatic["expected"] < 2.0 * error
    shortest, longest = values["models"]["hydrostatic"]["wall_s"]
    assert longest == pytest.approx(1.5**2 * shortest)  # a factor of 1.5 either way
    memory = {name: model["memory_bytes"] for name, model in values["models"].items()}
    assert 1e8 < memory["hydrostatic"] < memory["openfoam"] < 1e9
    assert values["models"]["openfoam"]["wall_s"] > values["models"]["hydrostatic"]["wall_s"]
    assert values["numbers"]["bond"] == pytest.approx(997 * 9.81 * 0.4445**2 / 0.073)


def test_check_says_what_the_cloth_leaves_out(case: Path):
    result = edt("check", case)
    shown = " ".join(result.stdout.replace("│", " ").split())
    values = json.loads(edt("check", case, "--json").stdout)["numbers"]
    assert f"spacing of the cloth's grid [m] {values['grid_spacing']:.4g}" in shown
    assert "finest wrinkling on this grid relaxed" in shown
    taut = f"a strain of about {values['membrane_parameter']:.2g} where the diaphragm is taut"
    assert f"{taut}, which inextensibility leaves out." in shown
    elastic = " ".join(edt("check", case, "--set", "diaphragm.inextensible=false").stdout.split())
    assert f"{taut}." in elastic


def test_verify_prints_a_case_as_json_and_as_a_table():
    values = json.loads(edt("verify", "numbers", "--json").stdout)
    assert sorted(values) == ["case", "options", "quantities", "wall_s"]
    assert sorted(values["quantities"][0]) == ["computed", "error", "exact", "name", "unit"]
    result = edt("verify", "eq46", "--resolution", "3")
    assert result.exit_code == 0
    assert "as_printed" in result.stdout


def test_verify_without_a_case_runs_all_and_exits_1_when_one_fails(monkeypatch):
    for name in set(CASES) - {"eq46", "numbers"}:
        monkeypatch.delitem(CASES._places, name)
    assert edt("verify").exit_code == 0
    monkeypatch.setitem(CASES._places, "lost", "coupling.verify.no_such_module:lost")
    result = edt("verify", "--json")
    assert result.exit_code == 1
    values = json.loads(result.stdout)
    assert [case["case"] for case in values["cases"]] == ["eq46", "numbers"]
    assert "lost" in values["failures"]


@pytest.mark.parametrize("name", ["eq46", "numbers"])
def test_every_case_takes_a_resolution(name: str):
    assert "resolution" in case_options(name)
    assert run_case(name, {"resolution": "7"}).options["resolution"] == 7


def test_option_pairs_take_both_spellings():
    assert option_pairs(["--length-ratio=1.5", "--mode", "1,2"]) == {
        "length-ratio": "1.5",
        "mode": "1,2",
    }


def test_info_says_what_is_there_and_what_is_not(monkeypatch, tmp_path: Path):
    monkeypatch.setenv("PATH", str(tmp_path))
    result = edt("info", "--json")
    assert result.exit_code == 0
    values = json.loads(result.stdout)
    assert values["openfoam"].startswith("not found")
    assert "numpy" in values
    assert "numpy" in edt("info").stdout


def test_every_verb_has_its_help():
    listed = edt("--help").stdout
    for verb in ("run", "resume", "study", "report", "check", "verify", "info"):
        assert verb in listed
        assert edt(verb, "--help").exit_code == 0


def test_check_says_in_words_what_lies_beyond_the_data(case: Path):
    """f/f1 and a/g of the data end far below these."""
    result = edt("check", case, "--set", "motion.amplitude=100.0", "--set", "model.tolerance=1e-6")
    assert result.exit_code == 0
    assert "beyond the data" in result.stdout
    assert "a/g" in result.stdout
    assert "is taken" not in result.stdout
    text = " ".join(result.stdout.split())
    assert "no model without a mesh keeps 1e-06 in nine scenes of ten" in text
