"""A shell by its meridian: a sphere of arcs against the sphere, a pill against its formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shells import pill, sphere_of_arcs

from cloth.node_kernels import contact_step
from cloth.shell.meridian import Meridian
from cloth.shell.pieces import arc, line
from cloth.shell.sphere import Sphere

R = 0.4445
ROUNDING = 1e-14 * R  # a few tens of operations on lengths of the order of R


@pytest.fixture
def points() -> np.ndarray:
    """Inside and outside, all round, on the axis as well, but not at the centre."""
    rng = np.random.default_rng(1)
    way = rng.normal(size=(200, 3))
    way /= np.linalg.norm(way, axis=1)[:, None]
    return R * np.vstack([rng.uniform(0.3, 1.5, (200, 1)) * way, [[0.0, 0.0, 1.2]]])


@pytest.mark.parametrize("cuts", [(), (-0.7, 0.2, 0.9), (0.0,)])
def test_a_sphere_of_arcs_is_the_sphere(points: np.ndarray, cuts: tuple[float, ...]):
    arcs, sphere = sphere_of_arcs(R, cuts), Sphere(R)
    for name in ("gap", "normal", "project", "confine"):
        wanted, got = (getattr(shell, name)(points) for shell in (sphere, arcs))
        np.testing.assert_allclose(got, wanted, atol=1e-14)
    deep = sphere.confine(points, 0.1)
    np.testing.assert_allclose(arcs.confine(points, 0.1), deep, atol=ROUNDING)
    inside = points[np.linalg.norm(points, axis=1) < R]
    shift = np.array([0.3, -0.2, 0.4]) * R
    share = sphere.share_within(inside, shift)
    assert arcs.share_within(inside, shift) == pytest.approx(share, abs=1e-13)
    for height in (-0.9 * R, -0.3 * R, 0.0, 0.5 * R, R):
        assert arcs.volume_below(height) == pytest.approx(sphere.volume_below(height), rel=1e-13)
    assert arcs.volume == pytest.approx(sphere.volume, rel=1e-13)
    assert arcs.size == pytest.approx(R, rel=1e-15)
    np.testing.assert_allclose(arcs.poles, sphere.poles, rtol=1e-15)
    along = np.linspace(-1.5, 1.5, 9) * R
    np.testing.assert_allclose(arcs.along(along), sphere.along(along), atol=ROUNDING)
    for height in (-0.9 * R, 0.0, 0.4 * R):
        assert arcs.arc_to(height) == pytest.approx(sphere.arc_to(height), abs=10 * ROUNDING)


@pytest.mark.parametrize("friction", [0.0, 0.3, 5.0])
def test_the_compiled_contact_of_both_is_the_same(points: np.ndarray, friction: float):
    """Sticking and sliding nodes, and free ones."""
    rng = np.random.default_rng(2)
    start = Sphere(R).confine(points + 0.1 * R * rng.normal(size=points.shape))
    answers = []
    for shell in (Sphere(R), sphere_of_arcs(R)):
        z, u, rub, rhs = points.copy(), *np.zeros((3, *points.shape))
        weight = np.ones(len(points))
        contact_step(points, shell.profile, weight, 1.0, friction, start, z, u, rub, rhs)
        answers.append((z, u, rub, rhs))
    for wanted, got in zip(*answers, strict=True):
        np.testing.assert_allclose(got, wanted, atol=100 * ROUNDING)
    assert np.any(answers[0][2]) == (friction > 0.0)


def test_the_nearest_point_of_a_pill_against_many_points_on_it(points: np.ndarray):
    """No point of a dense cloud on the pill is nearer, and one is as near to second order.

    A point beside the nearest one by half a spacing s is farther by s^2/8 (1/d + 1/R) or less.
    """
    half, spacing = 0.6 * R, 1e-3 * R
    shell = pill(R, half)
    length = 0.5 * math.pi * R + half
    r, z = shell.along(np.arange(-length, length, spacing))
    across, height = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
    away = np.hypot(across[:, None] - r, height[:, None] - z).min(axis=1)
    gap = shell.gap(points)
    assert np.all(np.abs(gap) <= away + ROUNDING)
    assert np.all(away <= np.hypot(gap, 0.5 * spacing) * (1.0 + spacing / R))
    moved = shell.project(points) - points
    np.testing.assert_allclose(moved, gap[:, None] * shell.normal(points), atol=ROUNDING)
    inside = np.hypot(across, np.maximum(np.abs(height) - half, 0.0)) < R
    np.testing.assert_array_equal(gap > 0.0, inside)


def test_a_pill_s_volumes_and_lengths():
    half = 0.7 * R
    shell = pill(R, half)
    ball, cylinder = 4.0 / 3.0 * math.pi * R**3, 2.0 * math.pi * R**2 * half
    assert shell.volume == pytest.approx(ball + cylinder, rel=1e-13)
    assert shell.volume_below(0.0) == pytest.approx(0.5 * (ball + cylinder), rel=1e-13)
    assert shell.poles == pytest.approx((-R - half, R + half))
    assert shell.size == R
    assert shell.arc_to(half) == pytest.approx(half, rel=1e-13)


def test_on_a_pill_s_cylinder_friction_is_that_of_a_plane_along_it():
    """A node pushed out by d sticks within mu d of where it was, and slides to mu d otherwise."""
    shell, friction, d = pill(R, R), 0.3, 1e-3
    asked = np.array([[R + d, 0.0, 0.0], [R + d, 0.0, 0.0]])
    start = np.array([[R, 0.0, 0.9 * friction * d], [R, 0.0, 3.0 * friction * d]])
    z, u, rub, rhs = asked.copy(), *np.zeros((3, 2, 3))
    contact_step(asked, shell.profile, np.ones(2), 1.0, friction, start, z, u, rub, rhs)
    wanted = [[R, 0.0, 0.9 * friction * d], [R, 0.0, friction * d]]
    np.testing.assert_allclose(z, wanted, atol=ROUNDING)


def test_wrong_meridians_are_refused():
    quarter = arc((0.0, 0.0), 1.0, -0.5 * math.pi, 0.0)
    with pytest.raises(ValueError, match="where the one before ends"):
        Meridian([quarter, line((0.9, 0.0), (0.0, 1.0))])
    with pytest.raises(ValueError, match="on the axis"):
        Meridian([quarter])
    with pytest.raises(ValueError, match="below and above"):
        Meridian([quarter, line((1.0, 0.0), (0.0, -0.5))])
    with pytest.raises(ValueError, match="half a circle"):
        arc((0.0, 0.0), 1.0, -2.0, 2.0)
