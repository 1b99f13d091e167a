"""A cylinder buckled into waves that are known, and a sphere with noise."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import known_run as run
import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.state import ClothState, untouched
from coupling.metrics.fold_figures import FoldFigures, fold_summary
from coupling.metrics.folds import FoldFinder
from coupling.metrics.summary import summarise
from coupling.ports import Array, Ints
from coupling.scene.scene import Scene
from coupling.store.results import read_results

RADIUS = 0.4


def cylinder(rings: int, around: int) -> tuple[Array, Ints]:
    """A cylinder's points (n, 3) [m] about z > 0, and triangles (m, 3)."""
    angle = 2.0 * np.pi * np.arange(around) / around
    height = 0.2 + np.arange(rings) * 2.0 * np.pi * RADIUS / around
    points = [[RADIUS * np.cos(a), RADIUS * np.sin(a), z] for z in height for a in angle]
    here, beside = np.arange(around), (np.arange(around) + 1) % around
    triangles = [
        part
        for low in around * np.arange(rings - 1)
        for part in (
            np.stack([low + here, low + beside, low + around + here], axis=1),
            np.stack([low + beside, low + around + beside, low + around + here], axis=1),
        )
    ]
    return np.array(points), np.concatenate(triangles)


def buckled(points: Array, waves: int, depth: float) -> tuple[Array, float]:
    """The cylinder with a tangent that swings by ``depth`` [rad], and its largest curvature [1/m].

    Inextensible: the tangent's angle along the arc s is s/R + depth sin(waves s/R), its rate the
    curvature, 1/R (1 + depth waves) at the most. The curve closes for more than one wave.
    """
    fine = np.linspace(0.0, 2.0 * np.pi, 200001)
    tangent = fine + depth * np.sin(waves * fine) + 0.5 * np.pi
    middle = 0.5 * (tangent[1:] + tangent[:-1])
    step = RADIUS * (fine[1] - fine[0])
    x = np.concatenate([[0.0], np.cumsum(np.cos(middle)) * step])
    y = np.concatenate([[0.0], np.cumsum(np.sin(middle)) * step])
    angle = np.arctan2(points[:, 1], points[:, 0]) % (2.0 * np.pi)
    moved = np.stack([np.interp(angle, fine, x), np.interp(angle, fine, y), points[:, 2]], axis=1)
    return moved, (1.0 + depth * waves) / RADIUS


@pytest.mark.parametrize(("waves", "depth"), [(2, 0.8), (3, 1.0), (7, 0.6), (12, 0.5)])
def test_waves_of_a_buckled_cylinder_are_counted_exactly(waves: int, depth: float) -> None:
    """The sharpest radius to second order in the grid's h: a curve's second difference lacks
    h^2/12 times n.x'''', and that is k'' - k^3; k'' is at most k times (waves/R)^2."""
    around = 24 * waves
    points, triangles = cylinder(9, around)
    position, sharpest = buckled(points, waves, depth)
    found = FoldFinder(points, triangles).folds(position)
    assert len(found.ridges) == waves
    spacing = 2.0 * np.pi * RADIUS / around
    error = spacing**2 / 12.0 * ((waves / RADIUS) ** 2 + sharpest**2)
    assert found.radius == pytest.approx(1.0 / sharpest, rel=error)
    azimuth = np.arctan2(points[found.ridges, 1], points[found.ridges, 0])
    assert np.abs(np.sin(waves * azimuth)).max() < 1e-9


@pytest.mark.parametrize("rings", [16, 40])
def test_noise_makes_no_folds(rings: int) -> None:
    """1e-6 R over a spacing h of 1.57 R/rings bends by some 6e-6/h^2, 0.4 % of 1/R on 40 rings."""
    mesh = hemisphere(RADIUS, rings)
    noise = 1e-6 * RADIUS * np.random.default_rng(3).standard_normal(mesh.points.shape)
    finder = FoldFinder(mesh.points, mesh.triangles)
    for shape in (mesh.points, mesh.points * [1.0, 1.0, -1.0]):
        found = finder.folds(shape + noise)
        assert len(found.ridges) == 0
        assert found.radius == pytest.approx(RADIUS, rel=0.05)
        assert found.radius <= found.tenth_radius == pytest.approx(RADIUS, rel=0.05)
    assert finder.folded_area(mesh.points + noise) == 0.0


def test_half_of_the_everted_sphere_has_turned_over() -> None:
    """Beyond 45 degrees from the pole, cos 45 of the half sphere; to a ring of triangles."""
    mesh = hemisphere(RADIUS, 32)
    finder = FoldFinder(mesh.points, mesh.triangles)
    turned = finder.folded_area(mesh.points * [1.0, 1.0, -1.0])
    assert turned / finder.area == pytest.approx(np.cos(np.pi / 4.0), abs=np.pi / 64.0)


def settings(**changes: object) -> Scene:
    """The known run's scene, 0.4 m and 1.8 mm, with other keys of its cloth."""
    scene = run.scene()
    return scene.model_copy(update={"cloth": scene.cloth.model_copy(update=changes)})


def state_of(position: Array, self_pressure: Array) -> ClothState:
    still = np.zeros(len(position))
    return ClothState(
        position=position, velocity=0.0 * position, datum_pressure=0.0, volume=0.0, strain=still,
        tension=still, contact_force=0.0 * position, shell_pressure=still,
        self_pressure=self_pressure, change=0.0, **untouched(len(position)),
    )  # fmt: skip


def told(scene: Scene, position: Array, points: Array, triangles: Ints) -> dict[str, Any]:
    """What a summary says of two steps: as moulded, then at ``position`` with a touch."""
    figures = FoldFigures(scene, points, triangles)
    touch = np.zeros(len(points))
    before = figures.metrics(state_of(points, touch))
    touch[3] = 10.0
    steps = before, figures.metrics(state_of(position, touch))
    series = {name: np.array([step[name] for step in steps]) for name in before}
    finder = FoldFinder(points, triangles)
    return fold_summary(np.array([0.0, 0.1]), series, scene, finder, position)


def test_a_summary_tells_of_the_sharpest_step_or_why_it_cannot() -> None:
    points, triangles = cylinder(9, 72)
    position, _ = buckled(points, 3, 1.0)
    found = told(settings(wrinkling="resolved", resolution=60), position, points, triangles)
    radius = FoldFinder(points, triangles).folds(position).radius
    assert found["number_max"] == found["number_end"] == len(found["ridges_end_deg"]) == 3
    assert found["sharpest_radius_m"] == radius
    assert found["sharpest_radius_over_thickness"] == pytest.approx(radius / 0.0018)
    assert found["sharpest_tenth_radius_m"] > radius
    assert found["sharpest_radius_resolved"] is True
    assert found["sharpest_time_s"] == 0.1
    assert found["layers_touch"] is True
    assert found["layers_touch_share_of_steps"] == 0.5
    assert found["below_grid"] is None
    coarse = told(settings(), position, points, triangles)
    assert coarse["number_max"] is coarse["sharpest_radius_m"] is None
    assert coarse["below_grid"].startswith("below the grid: to resolve the elasto-gravity wave")
    assert coarse["folded_area_max_m2"] == found["folded_area_max_m2"]


def test_a_run_that_did_not_tell_of_folds_has_nulls(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    stated = summarise(results, run.statistics(), run.scene(), "completed", None)["folds"]
    assert {value for name, value in stated.items() if name != "below_grid"} == {None}
