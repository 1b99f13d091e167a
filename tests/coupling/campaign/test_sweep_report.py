"""The report of a sweep, from rows of known errors."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_sweep_plan import SCENE
from typer.testing import CliRunner

from coupling.campaign.sweep_plan import parse_axis, plan_sweep
from coupling.campaign.sweep_rows import row_of, sweep_json
from coupling.cli.main import app
from coupling.report import write_report
from coupling.report.sweep_grid import Grid
from coupling.store.atomic import write_json

FREQUENCY = "motion.frequency=0.1:1:4:log"
FILL = "liquid.fill_fraction=0.4:0.8:3"


def content(
    folder: Path, overs: list[str], error: Callable[[float], float] = np.square
) -> dict[str, Any]:
    """Rows of a sweep whose hydrostatic CG error is ``error`` of f/f1, its shape a tenth of it."""
    (folder / "scene.toml").write_text(SCENE)
    models = ("hydrostatic", "potential")
    plan = plan_sweep(folder, (), [parse_axis(over) for over in overs], models)
    rows = []
    for point in plan.points:
        failed = {name: {"status": "failed", "error": "no run"} for name in models}
        row = row_of(point, folder / "none", failed)
        ratio = row["numbers"]["frequency_ratio"]
        for name in models:
            wrong = float(error(ratio)) if name == "hydrostatic" else 0.0
            errors = {"cg_amplitude": wrong, "shape_rms": 0.1 * wrong, "force_amplitude": None}
            row["models"][name] |= {"status": "completed", "failure": None, "error": errors}
        rows.append(row | {"reference": "potential", "failure": None})
    return sweep_json(plan, "Sway", rows)


def page(folder: Path, known: dict[str, Any]) -> str:
    write_json(folder / "sweep.json", known)
    return write_report(folder).read_text(encoding="utf-8")


def test_the_verdict_counts_and_finds_the_frequency_up_to_which_all_are_good(tmp_path: Path):
    known = content(tmp_path, [FREQUENCY])
    text = page(tmp_path, known)
    ratios = [row["numbers"]["frequency_ratio"] for row in known["rows"]]
    good = [ratio for ratio in ratios if ratio**2 <= 0.05]
    assert len(good) == 2
    assert (
        "Hydrostatic stays within 5\u202f% of potential in CG amplitude at 2 of 4 points." in text
    )
    assert f"Every point up to f/f₁ = {good[-1]:.3g} does." in text
    assert "force amplitude" in text


def test_a_good_point_above_a_bad_one_does_not_count_as_reached(tmp_path: Path):
    """Errors that fall with the frequency: only the highest is good."""
    known = content(tmp_path, [FREQUENCY], lambda ratio: 0.02 / ratio)
    text = page(tmp_path, known)
    assert "at 1 of 4 points" in text
    assert "No frequency is known up to which every point does." in text


@pytest.mark.parametrize(
    ("overs", "pictures"),
    [
        ([FREQUENCY], 4),  # CG and shape over Hz and over f/f1
        ([FREQUENCY, FILL], 6),  # four maps and two families of curves
        ([FILL, FREQUENCY], 6),
        (["motion.amplitude=0.001:0.002:2", FILL], 4),  # no f/f1: two maps, two curves
        ([FREQUENCY, FILL, "motion.amplitude=0.001,0.002"], 2),
        (["coupling.scheme=aitken,iqn-ils"], 0),
    ],
)
def test_pictures_follow_the_axes(tmp_path: Path, overs: list[str], pictures: int):
    text = page(tmp_path, content(tmp_path, overs))
    assert text.count("<img ") == pictures
    assert text.count("<tr>") > 4


def test_failures_and_points_to_come_are_told_and_left_out_of_the_arrays(tmp_path: Path):
    known = content(tmp_path, [FREQUENCY, FILL])
    broken = known["rows"][4]
    broken |= {"reference": "hydrostatic", "failure": "potential: the mesh <broke>"}
    broken["models"]["hydrostatic"]["error"] = {"cg_amplitude": 0.0, "shape_rms": 0.0}
    del known["rows"][-1]
    grid = Grid(content=known)
    error = grid.error("hydrostatic", "cg_amplitude")
    assert np.argwhere(np.isnan(error)).tolist() == [[1, 1], [3, 2]]
    assert np.argwhere(grid.failed()).tolist() == [[1, 1]]
    expected = known["rows"][5]["numbers"]["frequency_ratio"] ** 2
    assert error[1, 2] == pytest.approx(expected, rel=1e-12)
    text = page(tmp_path, known)
    assert "1 of 11 points have a model that failed." in text
    assert "potential: the mesh &lt;broke&gt;" in text
    assert "11 of 12 points" in text
    assert "Crosses: a model failed." in text


def test_the_command_builds_the_page_again(tmp_path: Path):
    page(tmp_path, content(tmp_path, [FREQUENCY]))
    (tmp_path / "report.html").unlink()
    result = CliRunner().invoke(app, ["report", str(tmp_path)])
    assert result.exit_code == 0
    assert (tmp_path / "report.html").is_file()
    picture = CliRunner().invoke(app, ["render", str(tmp_path), "-o", "a.png"])
    assert picture.exit_code == 2
    assert "is no run" in picture.stderr
