"""The inviscid liquid of harmonic polynomials: its walls, and the finite volumes beside it."""

import numpy as np
import pytest

from cloth.shell.sphere import Sphere
from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import half_ball
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.fluids.potential.ritz import RitzLiquid, wall_integral
from coupling.verify.cylinder import cylinder_samples

DENSITY = 1000.0


def normal_slopes(harmonics, points, area):
    """Derivatives (N, k) of the harmonics along the area vectors, times the area."""
    values = harmonics.values(points)
    return sum((values @ slope) * area[:, [x]] for x, slope in enumerate(harmonics.slopes))


def assert_green(harmonics, wall, lid):
    """int grad H_i . grad H_j dV by cones is int H_i dH_j/dn dS, over a closed surface."""
    by_cones = wall_integral(harmonics, *wall) + wall_integral(harmonics, *lid)
    points, area = (np.concatenate(pair) for pair in zip(wall, lid, strict=True))
    values = harmonics.values(points)
    by_surface = values.T @ normal_slopes(harmonics, points, area)
    assert np.abs(by_cones - by_surface).max() < 1e-11 * np.abs(by_surface).max()
    assert np.abs(area.sum(axis=0)).max() < 1e-13 * np.abs(area).sum()


@pytest.mark.parametrize("level", [-0.6, 0.0, 0.8])
def test_samples_of_a_cap_are_exact(level):
    harmonics = SolidHarmonics(7, 0.4445)
    rim = 0.4445 * np.sqrt(1 - level**2)
    points, area = bottom_of_cylinder(7, rim)
    points[:, 2] = level * 0.4445
    assert_green(harmonics, Sphere(0.4445).quadrature(7, 0.4445 * level), (points, -area))


@pytest.mark.parametrize("depth", [0.2, 3.0])
def test_samples_of_a_cylinder_are_exact(depth):
    harmonics = SolidHarmonics(7, 1.0)
    points, area = bottom_of_cylinder(7, 0.7)
    points[:, 2] = depth / 2
    assert_green(harmonics, cylinder_samples(7, 0.7, depth / 2), (points, -area))


def bottom_of_cylinder(degree, radius):
    """Samples of a disc, its area vectors pointing down."""
    points, area = cylinder_samples(degree, radius, 1.0)
    bottom = slice(len(points) // 2, None)
    return points[bottom], area[bottom]


def liquid_below(mesh, degree):
    """The liquid in the unit ball below the diaphragm of ``mesh``."""
    harmonics, faces = SolidHarmonics(degree, 1.0), mesh.patch_faces
    triangles = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    wall = wall_integral(harmonics, *Sphere(1.0).quadrature(degree))
    return RitzLiquid(triangles=triangles, harmonics=harmonics, wall=wall, density=DENSITY)


def test_kinetic_energy_agrees_with_the_finite_volumes():
    """On a level surface both are of second order, so that their difference is."""
    differences = []
    for cells in (180, 2400):  # n = 4 and 10 cells along an edge
        mesh = half_ball(cells)
        points = mesh.points[mesh.patch_points]
        x, y, _ = points.T
        heights = np.array([x, x * y, x**2 - y**2, x**3])
        volumes = LiquidInertia.of(
            NeumannLaplacian(mesh, cell_geometry(mesh, mesh.points)), points, DENSITY
        )
        ours, theirs = (
            np.sum((rows[:, :, 2] @ heights.T) ** 2, axis=0)
            for rows in (liquid_below(mesh, 10).at(points).rows(), volumes.rows)
        )
        differences.append(np.abs(ours / theirs - 1))
    assert (np.log(differences[0] / differences[1]) / np.log(10 / 4) > 1.6).all()
    # x^2 - y^2 is the coarsest seen: each of its four lobes has a handful of faces.
    assert differences[1].max() < 0.03


SOURCES = np.array([(0.2, 0.1, 0.6), (-0.3, 0.2, 0.7)])  # above the sheet, of opposite strength
DENT = 0.25


def exact(x):
    """Potential (...,) and velocity (..., 3) of two sources in the gas, the shell being tight."""
    potential, velocity = 0.0, 0.0
    for sign, y in zip((1, -1), SOURCES, strict=True):
        r = np.linalg.norm(x - y, axis=-1)
        xx, xy, yy = np.sum(x * x, -1), x @ y, y @ y
        s = np.sqrt(1 - 2 * xy + xx * yy)
        reach = 1 - xy + s
        by_s = (x * yy - y) / s[..., None]
        velocity = velocity - sign * (
            (x - y) / r[..., None] ** 3 + by_s / s[..., None] ** 2 + (by_s - y) / reach[..., None]
        )
        potential = potential + sign * (1 / r + 1 / s - np.log(reach))
    return potential, velocity


def dented(x, y):
    """Height of a sheet in the unit ball, its border on the equator."""
    return DENT * (1 - x**2 - y**2) * (np.cos(3 * x) + y - 1.5)


def exact_energy():
    """rho/2 int phi u.n dS over the dented sheet, to rounding: Gauss along and even ones around."""
    node, weight = np.polynomial.legendre.leggauss(40)
    angle = 2 * np.pi * np.arange(160) / 160
    distance = (node + 1)[:, None] / 2
    x, y = distance * np.cos(angle), distance * np.sin(angle)
    inside, wave = 1 - x**2 - y**2, np.cos(3 * x) + y - 1.5
    by_x = DENT * (-2 * x * wave - 3 * inside * np.sin(3 * x))
    by_y = DENT * (-2 * y * wave + inside)
    potential, velocity = exact(np.stack([x, y, dented(x, y)], axis=-1))
    flux = velocity[..., 2] - velocity[..., 0] * by_x - velocity[..., 1] * by_y
    size = weight[:, None] / 2 * distance * 2 * np.pi / len(angle)
    return 0.5 * DENSITY * np.sum(potential * flux * size)


def test_energy_of_an_exact_flow_below_a_dented_sheet():
    """The energy is short by the square of the grid's spacing, and by what no polynomial holds."""
    wanted, errors = exact_energy(), []
    for cells in (180, 550, 2400):  # n = 4, 6 and 10 cells along an edge
        mesh = half_ball(cells)
        points = mesh.points[mesh.patch_points].copy()
        points[:, 2] = dented(points[:, 0], points[:, 1])
        shape = liquid_below(mesh, 10).at(points)
        errors.append(1 - shape.kinetic_energy(exact(points)[1]) / wanted)
    assert errors[-1] < 0.03
    assert np.log(errors[0] / errors[-1]) / np.log(10 / 4) > 1.8
    coarse = 1 - liquid_below(mesh, 4).at(points).kinetic_energy(exact(points)[1]) / wanted
    assert coarse > 2 * errors[-1]  # Ritz: fewer polynomials, less energy
