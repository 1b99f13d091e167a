"""A shell by its meridian: a sphere of arcs against the sphere, a pill against its formulas."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shells import pill, sphere_of_arcs

from cloth.mesh import moulded
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


@pytest.mark.parametrize("up", [(0, 0, 1), (0, 0, -1), (1e-3, 0, 1), (1, 0, 0), (-0.2, 0.5, -0.4)])
@pytest.mark.parametrize("fill", [1e-3, 0.3, 0.8])
def test_the_level_in_a_sphere_of_arcs_however_it_lies(up: tuple[float, ...], fill: float):
    """A plane cuts off the volume to rounding, near the poles to its root of it."""
    arcs, sphere, way = sphere_of_arcs(R), Sphere(R), np.array(up, dtype=float)
    wanted = sphere.level_of(fill * sphere.volume, way)
    assert arcs.level_of(fill * sphere.volume, way) == pytest.approx(wanted, abs=1e-12 * R)


def test_rays_moments_and_integrals_in_a_sphere_of_arcs(points: np.ndarray):
    """A quadrature of products of polynomials of degree 6, below the rim and below a level."""
    arcs, sphere = sphere_of_arcs(R), Sphere(R)
    ways = points / np.linalg.norm(points, axis=1)[:, None]
    np.testing.assert_allclose(arcs.on_rays(ways), sphere.on_rays(ways), atol=ROUNDING)
    np.testing.assert_allclose(arcs.scaled(1.1).on_rays(ways), 1.1 * R * ways, atol=2 * ROUNDING)
    for height in (0.0, 0.1):
        moment = sphere.moment_below(height)
        assert arcs.moment_below(height) == pytest.approx(moment, rel=1e-13)
        integrals = []
        for shell in (sphere, arcs):
            x, area = shell.quadrature(6, height)
            integrals.append((((x[:, 0] ** 2 + x[:, 1] * x[:, 2]) / R**2) ** 6) @ area)
        np.testing.assert_allclose(integrals[1], integrals[0], atol=1e-13 * R**2)


def test_rays_meet_a_pill(points: np.ndarray):
    shell = pill(R, R)
    place = shell.on_rays(points / np.linalg.norm(points, axis=1)[:, None])
    np.testing.assert_allclose(shell.gap(place), 0.0, atol=ROUNDING)
    np.testing.assert_allclose(np.cross(place, points), 0.0, atol=4 * ROUNDING * R)


def test_the_sheet_moulded_to_a_sphere_of_arcs_is_the_hemisphere():
    arcs, sphere = (moulded(shell.upper_part(), 12) for shell in (sphere_of_arcs(R), Sphere(R)))
    np.testing.assert_allclose(arcs.points, sphere.points, atol=ROUNDING)
    np.testing.assert_array_equal(arcs.triangles, sphere.triangles)
    np.testing.assert_allclose(arcs.rim_distance, sphere.rim_distance, atol=ROUNDING)
    chart = sphere_of_arcs(R).upper_part().directions(arcs.points)
    np.testing.assert_allclose(chart, sphere.points / R, atol=1e-13)


def test_the_chart_of_a_pill_s_upper_part_keeps_arc_lengths_and_azimuths():
    half = 0.5 * R
    mould = pill(R, half).upper_part()
    x = np.array([[0.0, R, 0.25 * half], [-R * math.sin(0.4), 0.0, half + R * math.cos(0.4)]])
    polar = 0.5 * math.pi * np.array([0.5 * math.pi * R + 0.75 * half, 0.4 * R])
    polar /= 0.5 * math.pi * R + half
    wanted = [[0.0, np.sin(polar[0]), np.cos(polar[0])], [-np.sin(polar[1]), 0.0, np.cos(polar[1])]]
    np.testing.assert_allclose(mould.directions(x), wanted, atol=1e-13)


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


def test_a_shell_with_an_edge_is_refused():
    """The distance from an edge is no product with one normal, and friction has a cone there."""
    flat = [line((0.0, -0.1), (0.3, -0.05)), line((0.3, -0.05), (0.3, 0.1))]
    with pytest.raises(ValueError, match="kink"):
        Meridian([*flat, line((0.3, 0.1), (0.0, 0.15))])


def peanut(bulge: float, waist: float, height: float) -> Meridian:
    """Two spheres of radius ``bulge`` at -/+ ``height``, joined by an arc with a ``waist`` [m]."""
    # the throat's centre (a, 0) lies as far from a bulge's as both radii together
    a = 0.5 * (height**2 - (bulge - waist) ** 2) / (bulge - waist)
    turn = math.atan2(height, a)
    quarter = 0.5 * math.pi
    return Meridian(
        [
            arc((0.0, -height), bulge, -quarter, turn),
            arc((a, 0.0), a - waist, math.pi + turn, math.pi - turn),
            arc((0.0, height), bulge, -turn, quarter),
        ]
    )


def test_a_shell_that_a_ray_meets_twice_is_refused():
    """A narrow waist: the bulges' sides face the origin where height sin(turn) > bulge."""
    assert peanut(0.3, 0.25, 0.2).size == pytest.approx(0.25)
    with pytest.raises(ValueError, match="a ray from the origin must meet it once"):
        peanut(0.3, 0.05, 0.45)
