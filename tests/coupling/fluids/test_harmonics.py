"""Solid harmonics, and the kinetic energy of a liquid whose potential is made of them."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.ritz import (
    RitzLiquid,
    cone_integral,
    wall_integral,
)
from coupling.interface.liquid_shape import liquid_cg

RADIUS = 0.4445
SHELL = Sphere(RADIUS)
SEED = np.random.default_rng(20)
POINTS = 0.3 * RADIUS * SEED.normal(size=(40, 3))


@pytest.fixture(scope="module")
def harmonics() -> SolidHarmonics:
    return SolidHarmonics(6, RADIUS)


def test_slopes_are_the_derivatives(harmonics):
    """Central differences err by h^2 of a third derivative: 1e-9 with h = 3e-5 R."""
    h = 3e-5 * RADIUS
    for axis, slope in enumerate(harmonics.slopes):
        shift = h * np.eye(3)[axis]
        rise = harmonics.values(POINTS + shift) - harmonics.values(POINTS - shift)
        exact = harmonics.values(POINTS) @ slope
        assert np.abs(rise / (2 * h) - exact).max() < 1e-7 * np.abs(exact).max()


def test_every_harmonic_obeys_laplace(harmonics):
    laplacian = sum(slope @ slope for slope in harmonics.slopes)
    largest = max(np.abs(slope @ slope).max() for slope in harmonics.slopes)
    assert np.abs(laplacian).max() < 1e-13 * largest


def test_mean_square_over_the_sphere_is_one(harmonics):
    """The half sphere's samples and their mirror images integrate products exactly."""
    points, area = SHELL.quadrature(harmonics.degree)
    points = np.concatenate([points, -points])
    weight = np.tile(np.linalg.norm(area, axis=1), 2)
    values = harmonics.values(points)
    mean = values.T @ (weight[:, None] * values) / (4 * np.pi * RADIUS**2)
    assert np.abs(mean - np.eye(len(mean))).max() < 1e-12


def test_cone_integral_is_that_of_the_ball(harmonics):
    """int |grad H|^2 dV = int H dH/dr dS = l 4 pi R for a mean square of one."""
    points, area = SHELL.quadrature(harmonics.degree)
    points, area = np.concatenate([points, -points]), np.concatenate([area, -area])
    reach = np.sum(points * area, axis=1)
    whole = cone_integral(harmonics.values(points), reach, harmonics)
    exact = np.diag(4 * np.pi * RADIUS * harmonics.degrees)
    assert np.abs(whole - exact).max() < 1e-11 * exact.max()


def lower(harmonics: SolidHarmonics) -> np.ndarray:
    """The shell's part of the integral, below the rim."""
    return wall_integral(harmonics, *SHELL.quadrature(harmonics.degree))


def crumpled(rings: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 3) [m] of a sheet with a bump on it, and its triangles."""
    mesh = hemisphere(RADIUS, rings)
    points = mesh.points.copy()
    points[:, 2] *= 0.4 + 0.5 * points[:, 0] / RADIUS
    return points, mesh.triangles


def test_momentum_is_the_mass_times_the_cg_velocity(harmonics):
    """rho int grad phi dV = m c' exactly: x, y and z are among the potentials.

    Of the sheet's quadrature alone: second order, 0.3 % of the grid's spacing over R squared.
    """
    errors = []
    for rings in (8, 16):
        points, triangles = crumpled(rings)
        liquid = RitzLiquid(
            triangles=triangles, harmonics=harmonics, wall=lower(harmonics), density=1e3
        )
        velocity = np.stack([points[:, 2], points[:, 0] ** 2, points[:, 2]], axis=1)
        velocity[hemisphere(RADIUS, rings).fixed] = 0.0
        shape = liquid.at(points)
        potential = shape.potential(velocity)
        wall, area = SHELL.quadrature(harmonics.degree)
        impulse = shape.force(shape.values @ potential).sum(axis=0)
        impulse += (harmonics.values(wall) @ potential) @ area
        step = 1e-6
        volume = 1.0
        moved = [
            liquid_cg(points + sign * step * velocity, triangles, SHELL, volume) for sign in (1, -1)
        ]
        rate = (moved[0] - moved[1]) / (2 * step)
        errors.append(np.linalg.norm(impulse - rate) / np.linalg.norm(rate))
    assert errors[1] < 0.01
    assert np.log2(errors[0] / errors[1]) > 1.5


def test_rows_and_potential_agree(harmonics):
    points, triangles = crumpled(8)
    liquid = RitzLiquid(
        triangles=triangles, harmonics=harmonics, wall=lower(harmonics), density=1e3
    )
    velocity = SEED.normal(size=points.shape)
    shape = liquid.at(points)
    rows = np.tensordot(shape.rows(), velocity, 2)
    assert shape.kinetic_energy(velocity) == pytest.approx(0.5 * rows @ rows, rel=1e-9)


@pytest.mark.parametrize("height", [-0.999, -0.9, 0.0, 0.9])
def test_energy_stays_positive_in_films(harmonics, height):
    """A sheet lying nearly on the shell below it, or folded over itself, has a finite energy."""
    mesh = hemisphere(RADIUS, 8)
    points = mesh.points.copy()
    points[:, 2] *= height
    points[40:60, 0] += 0.2 * RADIUS
    liquid = RitzLiquid(
        triangles=mesh.triangles, harmonics=harmonics, wall=lower(harmonics), density=1e3
    )
    energy = liquid.at(points).kinetic_energy(SEED.normal(size=points.shape))
    assert np.isfinite(energy)
    assert energy > 0.0
