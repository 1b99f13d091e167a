"""A sweep of one model whose tables have the figures that were asked for."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from small_scene import SMALL
from typer.testing import CliRunner

from coupling.campaign.sweep_plan import SweepError
from coupling.campaign.time_left import TimeLeft
from coupling.campaign.wanted import check_wanted, figure_at, unit_of_figure
from coupling.cli.main import app
from coupling.scene.scene import Scene, load_scene
from coupling.store.run_record import read_summary

SCENE = f"""\
{SMALL}ramp = 0.0
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


@pytest.fixture
def scene(path: Path) -> Scene:
    return load_scene(path)


def test_names_are_those_of_a_summary(scene: Scene) -> None:
    names = [
        "rubs.self_work_max_J_per_m2", "cg.amplitude_m.2", "wall_s", "coupling.iterations_max",
        "rubs.shell_work_place_deg.1", "impacts.impulse_max_Ns",  # below what only a run knows
    ]  # fmt: skip
    assert check_wanted(names, scene) == tuple(names)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("rubs.self_work_max", "Did you mean rubs.self_work_max_J_per_m2"),
        ("stress_max", "stress_max_Pa"),
        ("amplitude_m", "cg.amplitude_m.0"),
        ("cg.amplitude_m", "Give one or more of cg.amplitude_m.0, cg.amplitude_m.1"),
        ("cg.amplitude_m.3", "no summary has that"),
        ("rubs", "has several figures"),
        ("wall_s.first", "no summary has that"),
        ("model", "is a text, 'hydrostatic'"),
    ],
)
def test_a_wrong_name_is_refused_with_the_nearest(scene: Scene, name: str, said: str) -> None:
    with pytest.raises(SweepError) as refused:
        check_wanted([name], scene)
    assert str(refused.value).startswith(f"--want {name}: ")
    assert said in str(refused.value)


def test_a_figure_without_a_number_is_none() -> None:
    summary = {"rubs": {"place": None, "two": [1.0, 2]}, "model": "datum", "burst": False}
    assert figure_at(summary, "rubs.two.1") == 2
    assert figure_at(summary, "burst") is False
    for name in ("rubs.place.0", "rubs.two.2", "rubs.none", "model", "rubs", "rubs.two.first"):
        assert figure_at(summary, name) is None


def test_units_follow_from_names() -> None:
    assert unit_of_figure("cg.amplitude_m.0") == "m"
    assert unit_of_figure("rubs.self_work_max_J_per_m2") == "J m-2"
    assert unit_of_figure("folds.folded_area_max_fraction") == "1"


def test_the_time_left_goes_by_costs(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [0.0]
    monkeypatch.setattr("coupling.campaign.time_left.time.monotonic", lambda: now[0])
    left = TimeLeft()
    assert left.text(60.0) == ""
    now[0] = 40.0
    left.took(10.0)
    left.took(10.0)
    assert left.seconds(60.0) == 120.0
    assert left.text(60.0) == ", about 2 min left"
    assert left.text(0.0) == ""


def test_a_tidy_table_a_netcdf_file_and_a_figure_more_without_a_run(
    path: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "sweep"
    names = ["cg.amplitude_m.0", "force.peak_N.2"]

    def edt(want: str, *words: str) -> str:
        over = ["--over", "liquid.fill_fraction=0.6,0.7", "--workers", "1", "-o", str(folder)]
        done = CliRunner().invoke(app, ["sweep", str(path), *over, "--want", want, *words])
        assert done.exit_code == 0, done.output
        return done.stdout

    printed = json.loads(edt(",".join(names), "--json"))
    assert printed["models"] == ["hydrostatic"]
    assert printed["reference"] is None
    with (folder / "sweep.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["liquid.fill_fraction", "model", "status", *names, "failure"]
    data = xr.load_dataset(folder / "sweep.nc", engine="scipy")
    assert data[names[0]].attrs["units"] == "m"
    for row in rows:
        fill = float(row["liquid.fill_fraction"])
        place = folder / "points" / f"liquid.fill_fraction_{fill}" / "hydrostatic"
        for name in names:
            known = figure_at(read_summary(place), name)
            assert known is not None
            assert float(row[name]) == known
            here = data[name].sel({"liquid.fill_fraction": fill, "model": "hydrostatic"})
            assert np.float64(here) == known

    results = [file.stat().st_mtime_ns for file in sorted(folder.glob("points/*/*/results.h5"))]
    assert "stress_max_Pa" in edt("stress_max_Pa")
    later = [file.stat().st_mtime_ns for file in sorted(folder.glob("points/*/*/results.h5"))]
    assert results == later
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "2 of 2 runs completed" in page
    assert "stress_max_Pa" in page


def test_a_wrong_name_starts_nothing(path: Path, tmp_path: Path) -> None:
    words = ["sweep", path, "--over", "liquid.fill_fraction=0.6,0.7", "-o", tmp_path / "sweep"]
    done = CliRunner().invoke(app, [*map(str, words), "--want", "rubs.self_work"])
    assert done.exit_code == 2
    assert "rubs.self_work_max_J_per_m2" in done.output
    assert not (tmp_path / "sweep").exists()


def test_a_key_that_the_scene_needs_may_be_the_axis(path: Path, tmp_path: Path) -> None:
    """The scene's own model is looked up at the first point: without the axis there is no scene."""
    done = CliRunner().invoke(
        app,
        ["sweep", str(path), "--set", "tank.shape=pill", "--over", "tank.cylinder_length=0.05,0.1",
         "--want", "steps", "--workers", "1", "--json", "-o", str(tmp_path / "sweep")],
    )  # fmt: skip
    assert done.exit_code == 0, done.output
    assert json.loads(done.stdout)["models"] == ["hydrostatic"]
