"""Liquid drawn from a tank at rest: its volume, the pressure drop, the outlet."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from coupling.fluids.supply import DrawnTank, supply_of
from coupling.metrics.expulsion import covering_gap, work_of
from coupling.report.files import read_run
from coupling.report.run_report import run_page
from coupling.report.style import house_style
from coupling.scene.errors import SceneError
from coupling.scene.scene import Scene, load_scene
from coupling.scene.supply import drawing, film_fraction
from coupling.simulation.driver import run

TANK = """\
title = "Drawn empty"
[tank]
radius = 0.2
[diaphragm]
material = "AF-E-332"
thickness = 0.0018
[liquid]
name = "water"
fill_fraction = 0.95
[model]
fluid = "hydrostatic"
[supply]
end_fill_fraction = 0.02
duration = 100.0
[cloth]
resolution = 8
[time]
step = 2.0
output_every = 5
"""
RADIUS, WEIGHT = 0.2, 1070.0 * 0.0018 * 9.81  # of the rubber, per area [Pa]
SOFT = 8.6e4  # a hundredth of the rubber's modulus: hardly any bending stiffness
UP = np.array([0.0, 0.0, 1.0])


def scene_of(folder: Path, **changes: Any) -> Scene:
    (folder / "scene.toml").write_text(TANK)
    return load_scene(folder, {name.replace("__", "."): value for name, value in changes.items()})


def drawn(folder: Path, **changes: Any) -> tuple[Scene, dict[str, Any], Any]:
    """Scene, summary and results of every step of a run."""
    scene = scene_of(folder, **changes)
    summary = run(scene, folder / "run")
    assert summary["status"] == "completed"
    return scene, summary, read_run(folder / "run").results.steps


@pytest.mark.parametrize(
    ("changes", "problem"),
    [
        ({"model.fluid": "potential"}, 'supply: liquid can be drawn with model.fluid = "hydro'),
        ({"model.fluid": "openfoam"}, 'alone, got "openfoam": a flow has no outlet here. Set'),
        ({"model.fluid": "datum"}, 'alone, got "datum"'),
        ({"model.fluid": "auto"}, 'alone, got "auto"'),
        ({"diaphragm.held": True}, "supply: a diaphragm that is held cannot follow"),
        ({"supply.end_fill_fraction": 0.95}, "must be below liquid.fill_fraction (0.95), got 0.95"),
        ({"supply.end_fill_fraction": 0.003}, "Give more, or cloth.resolution = 21."),
        (
            {"motion.kind": "sine", "motion.frequency": 0.01, "motion.amplitude": 0.1},
            'from a tank at rest alone, got motion.kind = "sine". Set motion.kind = "rest"',
        ),
    ],
)
def test_what_cannot_be_drawn_is_refused_before_anything_starts(
    tmp_path: Path, changes: dict[str, Any], problem: str
):
    (tmp_path / "scene.toml").write_text(TANK)
    with pytest.raises(SceneError, match="supply") as refused:
        load_scene(tmp_path, changes)
    assert problem in str(refused.value)


@pytest.mark.parametrize("key", ["duration", "end_fill_fraction"])
def test_both_keys_are_required(tmp_path: Path, key: str):
    text = "\n".join(line for line in TANK.splitlines() if not line.startswith(f"{key} = "))
    (tmp_path / "scene.toml").write_text(text + "\nduration = 1.0\n")
    with pytest.raises(SceneError, match=rf"supply.{key}: is required beside"):
        load_scene(tmp_path)


def test_check_says_how_fast_it_is_drawn(tmp_path: Path):
    """sqrt(R/g) is 0.1428 s, five times which fold_damping acts; 0.93 of 33.5 l in 100 s."""
    said = drawing(scene_of(tmp_path))
    assert said == (
        "Liquid is drawn at 0.000312 m^3/s, in a step 0.019 of the tank, over 140 times as long as "
        "cloth.fold_damping acts."
    )


def test_volume_falls_evenly_and_then_stays(tmp_path: Path):
    scene = scene_of(tmp_path)
    whole = scene.tank.volume
    supply = supply_of(scene)
    assert supply == DrawnTank(0.95 * whole, 0.02 * whole, 100.0)
    for time, share in ((0.0, 0.95), (50.0, 0.485), (100.0, 0.02), (1e6, 0.02)):
        assert supply.volume(time) == pytest.approx(share * whole, rel=1e-15)
    assert scene.time.duration == 100.0  # the supply's, where [time] has none
    assert scene_of(tmp_path, time__duration=7.0).time.duration == 7.0


@pytest.mark.parametrize("thickness", [0.0009, 0.0018, 0.0036])
def test_tank_is_drawn_from_95_to_2_percent(tmp_path: Path, thickness: float):
    """The volume to 1e-12 at every step, and the work of the drop as the energies have it.

    It is the work of the datum, which the energies sum, less that of a level liquid's head; both by
    the trapezoidal rule over the same steps, and so to rounding.
    """
    scene, summary, steps = drawn(tmp_path, diaphragm__thickness=thickness)
    assert summary["volume_error_max"] < 1e-12
    found = summary["expulsion"]
    assert found["fill_fraction_end"] == pytest.approx(0.02, rel=1e-12)
    assert found["drawn_m3"] == pytest.approx(0.93 * scene.tank.volume, rel=1e-12)
    levels = [scene.tank.shell.level_of(float(volume), UP) for volume in steps.volume]
    head = 9.81 * scene.liquid.density * np.array(levels) + steps.metrics["pressure_drop_chords"]
    of_head = 0.5 * (head[1:] + head[:-1]) @ np.diff(steps.volume)
    assert found["work_J"] == pytest.approx(steps.metrics["datum_work"][-1] - of_head, abs=1e-9)
    assert work_of(steps)[-1] == found["work_J"]
    assert found["outlet_covered_at_fill"] is None
    assert found["inertia_ratio"] < 1e-5
    assert found["sheet_kinetic_energy_max_J"] < 1e-4
    if thickness == 0.0018:
        with house_style():
            page = run_page(read_run(tmp_path / "run"))
        assert "Expulsion" in [section.title for section in page.sections]
        assert page.verdict.startswith("Drawn from 95")


def test_soft_sheet_presses_with_its_weight_alone(tmp_path: Path):
    """Sheet of a level liquid: what was moulded above the level h lies on a disc of less area.

    2 pi R (R - h) on pi (R^2 - h^2): 2R/(R + h) times the weight per area. The rest is the grid's:
    on 12 rings the chords are 6 to 18 Pa before they are corrected for, and a sixth of that after.
    """
    scene, _, steps = drawn(
        tmp_path, diaphragm__youngs_modulus=SOFT, cloth__resolution=12,
        supply__end_fill_fraction=0.8, supply__duration=20.0,
    )  # fmt: skip
    heights = [scene.tank.shell.level_of(float(volume), UP) for volume in steps.volume]
    expected = -WEIGHT * 2.0 * RADIUS / (RADIUS + np.array(heights))
    drop, chords = steps.metrics["pressure_drop"], steps.metrics["pressure_drop_chords"]
    assert np.sqrt(np.mean((drop - expected) ** 2)) < np.sqrt(np.mean(chords**2)) / 6.0


def test_half_the_rate_changes_the_curve_by_less_than_its_stated_error(tmp_path: Path):
    curves = []
    for duration in (100.0, 200.0):
        folder = tmp_path / f"{duration:g}"
        folder.mkdir()
        _, summary, steps = drawn(
            folder, supply__duration=duration, time__step=duration / 100.0
        )  # the same volumes
        curves.append(steps.metrics["pressure_drop"])
        stated = summary["expulsion"]["pressure_drop_chords_Pa"]
        damped = summary["expulsion"]["pressure_drop_damping_Pa"]
    change = curves[1] - curves[0]
    assert np.sqrt(np.mean(change**2)) < 0.3 * stated
    assert abs(change.mean()) < 2.0 * damped + 0.5  # Pa


def test_outlet_of_a_tilted_tank_is_covered_while_liquid_is_left(tmp_path: Path):
    """At 45 degrees a level liquid leaves the lower pole when it is R (1 - cos 45) deep.

    That depth is known to the gap by which covering is seen, the volume to a step; and up to the
    film that the chords leave on the shell may stay besides.
    """
    scene, summary, _ = drawn(
        tmp_path, gravity=[6.94, 0.0, -6.94], liquid__fill_fraction=0.2,
        diaphragm__youngs_modulus=SOFT, supply__duration=50.0,
    )  # fmt: skip
    pole, gap = RADIUS * np.sqrt(0.5), covering_gap(scene)
    least, most = (
        scene.tank.shell.volume_below(height) / scene.tank.volume
        for height in (-pole - gap, -pole + gap)
    )
    step = 0.18 * scene.time.step / 50.0
    found = summary["expulsion"]["outlet_covered_at_fill"]
    assert least - step < found < most + film_fraction(scene) + step
    left = summary["expulsion"]["residual_volume_m3"]
    assert left == pytest.approx(found * scene.tank.volume, rel=1e-12)
