"""Design curves: of a synthetic criterion without any run, and of small real runs."""

from __future__ import annotations

import csv
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_scene import SMALL
from typer.testing import CliRunner

from coupling.campaign import design
from coupling.campaign.design_plan import plan_design
from coupling.campaign.parallel import Task
from coupling.cli.main import app
from coupling.metrics.criteria import CRITERIA
from coupling.scene.scene import load_scene

SCENE = f"""\
{SMALL.replace("amplitude = 0.002", "amplitude = 0.02").replace("0.8", "0.5")}ramp = 0.0
[model]
fluid = "hydrostatic"
[cloth]
resolution = 4
tolerance = 0.001
[time]
settle = 0.3
periods = 1
steps_per_period = 20
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


def curve(
    path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, value: Callable[[Any], Any]
) -> dict[str, Any]:
    """The design of a criterion whose value is that of the scene, in runs that are not made."""

    def in_parallel(
        tasks: Sequence[Task], _: object, __: object, more: Callable[[], Sequence[Task]]
    ) -> Iterator[tuple[Task, dict[str, Any]]]:
        waiting = list(tasks)
        while waiting:
            task = waiting.pop()
            found = value(task.scene)
            summary = {"status": "completed", "folds": {"folded_area_max_fraction": found}}
            failed = {"status": "failed", "error": "no mesh"}
            yield task, failed if found is None else summary
            waiting += more()

    folder.mkdir(exist_ok=True)
    monkeypatch.setattr(design, "in_parallel", in_parallel)
    monkeypatch.setattr(design, "write_report", lambda _: None)
    plan = plan_design(path, (), "0.2,0.4", "folds", 0.25, "0.0005:0.008")
    return design.run_design(plan, folder)


def test_a_curve_of_a_known_criterion(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """R/(400 t) is below 0.25 from t = R/100 on; mass, t/R and wavelength are those of formulas."""
    found = curve(
        path, tmp_path / "d", monkeypatch, lambda s: s.tank.radius / (400 * s.diaphragm.thickness)
    )
    assert [row["status"] for row in found["rows"]] == ["bracketed", "bracketed"]
    for row in found["rows"]:
        radius, enough = row["radius_m"], row["enough_m"]
        assert row["too_thin_m"] <= radius / 100 < enough <= 1.05 * row["too_thin_m"]
        assert row["monotonic"]
        scene = load_scene(path, [f"diaphragm.thickness={enough}"])
        rubber = scene.diaphragm
        # frusta of 2000 parts leave out 1e-7 of the area
        mass = rubber.density * enough * 2 * np.pi * radius**2
        assert row["mass_kg"] == pytest.approx(mass, rel=1e-6)
        length = (rubber.sheet.bending_stiffness / (scene.liquid.density * 9.81)) ** 0.25
        assert row["wavelength_over_radius"] == pytest.approx(2 * np.pi * length / radius)
    with (tmp_path / "d" / "design.csv").open() as file:
        assert [float(line["enough_m"]) for line in csv.DictReader(file)] == [
            row["enough_m"] for row in found["rows"]
        ]
    with (tmp_path / "d" / "runs.csv").open() as file:
        assert sum(1 for _ in csv.DictReader(file)) == sum(
            len(row["runs"]) for row in found["rows"]
        )


def test_a_wave_and_failures_are_told(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At 0.2 m what is thin keeps the limit too; at 0.4 m a run between the ends fails."""

    def value(scene: Any) -> float | None:
        thickness = scene.diaphragm.thickness
        if scene.tank.radius < 0.3:
            return 0.9 if 0.0015 < thickness < 0.003 else 0.1
        return None if 0.0015 < thickness < 0.003 else 0.0004 / thickness

    wavy, broken = curve(path, tmp_path / "d", monkeypatch, value)["rows"]
    assert wavy["status"] == "bracketed"
    assert not wavy["monotonic"]
    assert wavy["remarks"][0].startswith("not monotonic: 0.5, 1 mm keep the limit, but 2.9")
    assert broken["status"] == "a run between failed"
    assert (broken["too_thin_m"], broken["enough_m"]) == (0.001, 0.004)
    (failed,) = [run for run in broken["runs"] if run["status"] == "failed"]
    assert failed["failure"] == "no mesh"
    assert "runs failed at 2 mm" in broken["remarks"]


def test_criteria_are_figures_of_the_summary(path: Path) -> None:
    scene = load_scene(path, ["diaphragm.wear_coefficient=[1e-9,2e-9]", "diaphragm.strength=1e7"])
    rubs = {
        "self_work_max_J_per_m2": None,
        "shell_wear_max_m": [1e-6, 1.8e-6],
        "self_wear_max_m": None,
    }
    summary = {"folds": {"folded_area_max_fraction": 0.3}, "rubs": rubs, "stress_max_Pa": 2e6}
    found = {name: one.value(summary, scene) for name, one in CRITERIA.items()}
    assert found == pytest.approx({"folds": 0.3, "self_rub": 0.0, "wear": 1e-3, "burst": 0.2})


def edt(path: Path, folder: Path, *words: str) -> dict[str, Any]:
    """What the verb prints of a curve at two radii."""
    given = ["design", path, "--radius", ".2:.3:2", "--criterion", "burst", "-o", folder, *words]
    done = CliRunner().invoke(app, [*map(str, given), "--workers", "1", "--json"])
    assert done.exit_code == 0, done.output
    table: dict[str, Any] = json.loads(done.stdout)
    return table


def test_small_runs_are_bracketed_and_none_is_made_twice(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "design"

    def written() -> dict[Path, int]:
        return {file: file.stat().st_mtime_ns for file in folder.glob("points/*/*/results.h5")}

    words = ("--set", "diaphragm.strength=1e7", "--thickness", "0.0012:0.0015")
    first = edt(path, folder, "--limit", "1", *words)
    assert [row["status"] for row in first["rows"]] == ["kept throughout"] * 2
    before = written()
    assert len(before) == 10

    # half way between the values of the two thinnest, 6 % apart: halved once at the most
    values = [run["value"] for run in first["rows"][0]["runs"]]
    limit = 0.5 * (values[0] + values[1])
    again = edt(path, folder, "--limit", str(limit), *words)
    after = written()
    assert before.items() <= after.items()
    assert len(after) <= 12
    row = again["rows"][0]
    assert [run["kept"] for run in row["runs"]] == [run["value"] < limit for run in row["runs"]]
    assert row["status"] == "bracketed"
    assert row["enough_m"] <= 1.05 * row["too_thin_m"]
    assert edt(path, folder, "--limit", str(limit), *words) == again
    assert written() == after
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "At the ends of the brackets" in page
    assert "largest stress over diaphragm.strength" in page
    (folder / "report.html").unlink()
    assert CliRunner().invoke(app, ["report", str(folder)]).exit_code == 0
    assert (folder / "report.html").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--criterion", "folds"), "--limit"),
        (("--criterion", "fold", "--limit", "1"), "must be one of folds, self_rub, wear, burst"),
        (("--criterion", "folds", "--limit", "0"), "--limit: must be positive, got 0"),
        (("--criterion", "wear", "--limit", "0.1"), "diaphragm.wear_coefficient: the criterion"),
        (("--criterion", "folds", "--limit", "1", "--thickness", "2:1"), "the lesser first"),
        (("--criterion", "folds", "--limit", "1", "--thickness", "thin"), "least:largest"),
        (("--criterion", "folds", "--limit", "1", "--thickness", "0.001:0.05"), "below 0.05 radii"),
        (("--criterion", "folds", "--limit", "1", "--radius", "big"), "--radius: must be"),
        (("--criterion", "folds", "--limit", "1", "--set", "model.fluid=auto"), "model.fluid: all"),
    ],
)
def test_wrong_input_starts_nothing(
    path: Path, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    folder = tmp_path / "design"
    given = words if "--radius" in words else ("--radius", "0.2,0.3", *words)
    result = CliRunner().invoke(app, ["design", str(path), *given, "-o", str(folder)])
    assert result.exit_code == 2, result.output
    assert said in " ".join(result.output.split())
    assert not folder.exists()


def test_a_folder_of_another_scene_is_refused(path: Path, tmp_path: Path) -> None:
    folder = tmp_path / "design"
    place = folder / "points" / "tank.radius_0.2__diaphragm.thickness_0.0005" / "hydrostatic"
    place.mkdir(parents=True)
    (place / "scene.toml").write_text(SCENE.replace("frequency = 2.0", "frequency = 3.0"))
    (folder / "design.json").write_text("{}")
    words = ["--radius", "0.2,0.3", "--criterion", "folds", "--limit", "1"]
    words += ["--thickness", "0.0005:0.008", "-o", str(folder)]
    result = CliRunner().invoke(app, ["design", str(path), *words])
    assert result.exit_code == 2
    assert "motion.frequency: 3.0 -> 2.0" in result.output
