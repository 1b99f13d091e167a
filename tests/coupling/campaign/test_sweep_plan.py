"""Sweeps planned: axes from the command line, the grid, and what is wrong before anything runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_scene import SMALL

from coupling.campaign.sweep_plan import Axis, SweepError, parse_axis, plan_sweep
from coupling.scene.scene import SceneError

SCENE = f"""\
{SMALL}[time]
periods = 2
steps_per_period = 30
"""


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "scene.toml"
    file.write_text(SCENE)
    return file


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("a.b=0.1:0.4:4", (0.1, 0.2, 0.3, 0.4)),
        ("a.b=4:1:4", (4, 3, 2, 1)),
        ("a.b=1:2:3", (1.0, 1.5, 2.0)),
        ("a.b = 0.1, 1e-3,2", (0.1, 1e-3, 2)),
        ("a.b=aitken,iqn-ils", ("aitken", "iqn-ils")),
        ('a.b="x",true', ("x", True)),
        ("a.b=[1,0,0],[0.5, 1,0]", ([1, 0, 0], [0.5, 1, 0])),
    ],
)
def test_an_axis_is_a_range_or_a_list(text: str, values: tuple[object, ...]) -> None:
    axis = parse_axis(text)
    assert axis == Axis(key="a.b", values=values)
    assert [type(value) for value in axis.values] == [type(value) for value in values]


def test_log_spaces_geometrically() -> None:
    axis = parse_axis("f=0.1:4:12:log")
    ratios = np.array(axis.values[1:]) / np.array(axis.values[:-1])
    assert (axis.values[0], axis.values[-1], axis.logarithmic) == (0.1, 4.0, True)
    np.testing.assert_allclose(ratios, 40.0 ** (1 / 11), rtol=1e-11)  # values have 12 digits


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("motion.frequency", "must name a key and its values. Give key=start:stop:count"),
        ("=1,2", "must name a key and its values"),
        ("motion.frequency=", "must name a key and its values"),
        ("f=1:2", "is no range"),
        ("f=1:2:3:geo", "is no range"),
        ("f=1:two:3", "must be numbers, the count a whole one"),
        ("f=1:2:2.5", "must be numbers, the count a whole one"),
        ("f=1:2:1", "a count of 2 or more"),
        ("f=1:inf:3", "finite ends"),
        ("f=0:2:3:log", "geometric spacing needs positive ends"),
        ("f=1,2,1", "gives 1 twice"),
    ],
)
def test_a_wrong_axis_is_refused_with_the_mend(text: str, says: str) -> None:
    with pytest.raises(SweepError, match=r"^--over ") as error:
        parse_axis(text)
    assert says in str(error.value)


def test_every_combination_is_a_point_with_a_scene_of_each_model(path: Path) -> None:
    axes = [parse_axis("motion.frequency=0.5:2:2"), parse_axis("cloth.resolution=6:8:2")]
    plan = plan_sweep(path, ["liquid.fill_fraction=0.5"], axes, ("hydrostatic", "potential"))
    assert [tuple(point.values.values()) for point in plan.points] == [
        (0.5, 6), (0.5, 8), (2.0, 6), (2.0, 8),
    ]  # fmt: skip
    assert plan.points[0].name == "motion.frequency_0.5__cloth.resolution_6"
    for point in plan.points:
        for model, scene in point.scenes.items():
            assert scene.model.fluid == model
            assert scene.liquid.fill_fraction == 0.5
            assert scene.motion.frequency == point.values["motion.frequency"]
            assert scene.cloth.resolution == point.values["cloth.resolution"]
            assert scene.time.steps == 60  # two periods, whatever the frequency


def test_invalid_points_are_told_once_each_with_their_place(path: Path) -> None:
    axes = [parse_axis("liquid.fill_fraction=0.6:1.4:3"), parse_axis("cloth.resolution=2,6")]
    with pytest.raises(SceneError) as error:
        plan_sweep(path, (), axes, ("hydrostatic", "potential"))
    lines = error.value.problems
    assert len(lines) == 3
    assert lines[0].startswith("--over: cloth.resolution: must lie in [4, 200], got 2.")
    assert "(At liquid.fill_fraction=0.6, cloth.resolution=2.)" in lines[0]
    assert lines[1].startswith("--over: liquid.fill_fraction: must lie in (0, 1), got 1.0.")
    assert "got 1.4" in lines[2]


def test_what_cannot_be_a_grid_is_refused(path: Path) -> None:
    both = [parse_axis("motion.frequency=1,2"), parse_axis("motion.frequency=3,4")]
    for axes in ([], both):
        with pytest.raises(SweepError, match="must be given, and once for each key"):
            plan_sweep(path, (), axes, ("hydrostatic", "potential"))
    with pytest.raises(SweepError, match=r"--over model\.fluid: .* all models\. Name them"):
        plan_sweep(path, (), [parse_axis("model.fluid=datum,openfoam")], ("datum", "potential"))
    with pytest.raises(SceneError, match=r"unknown key\. Did you mean frequency\?"):
        plan_sweep(path, (), [parse_axis("motion.freqency=1,2")], ("hydrostatic", "potential"))
    with pytest.raises(SweepError, match="would share the folder title_a-b"):
        plan_sweep(path, (), [parse_axis("title=a/b,a b")], ("hydrostatic", "potential"))


def test_an_axis_of_lists_gives_scenes_and_folders(path: Path) -> None:
    """It was taken apart at the commas within the brackets: 'gives 0] twice'."""
    axis = parse_axis("motion.direction=[1,0,0],[0,1,0],[-1,0,0]")
    plan = plan_sweep(path, (), [axis], ("hydrostatic",))
    assert [point.name for point in plan.points] == [
        "motion.direction_1_0_0", "motion.direction_0_1_0", "motion.direction_-1_0_0",
    ]  # fmt: skip
    assert plan.points[1].scenes["hydrostatic"].motion.direction == (0, 1, 0)
    with pytest.raises(SweepError, match=r"gives \[1, 0, 0\] twice"):
        parse_axis("motion.direction=[1,0,0],[0,1,0],[1,0,0]")


def test_an_enormous_grid_is_refused_with_its_cost(path: Path) -> None:
    for over in (
        ["tank.radius=0.2:0.3:1000000"],
        ["tank.radius=0.2:0.3:1000", "cloth.slack_drag=1:9:1000"],
    ):
        axes = [parse_axis(text) for text in over]
        with pytest.raises(SweepError, match=r"2,000,000 runs, some [\d,.]+ days of one core"):
            plan_sweep(path, (), axes, ("hydrostatic", "potential"))
    with pytest.raises(SweepError, match="1,000,000,000,000 values are too many"):
        parse_axis("tank.radius=0.2:0.3:1000000000000")
