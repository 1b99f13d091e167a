"""The discrete inertia: symmetric, positive, blind to a net flux, and exact in the limit."""

import numpy as np
import pytest
from laplacian_reference import laplacian, on_walls, pressure_beside_walls
from scipy.linalg import eigh

from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.gradients import gradients, wall_distance
from coupling.finite_volume.laplacian import eliminated
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.swept import swept_gradient, swept_rows

DENSITY = 1000.0


@pytest.fixture(scope="module")
def level():
    """Half-full unit tank below a flat surface: mesh, geometry, patch."""
    mesh = half_ball(650)
    return mesh, cell_geometry(mesh, mesh.points), mesh.points[mesh.patch_points]


def test_matrix_against_its_definition():
    mesh = half_ball(650)
    points = mesh.points + 0.05 * np.sin(4 * mesh.points[:, [1, 2, 0]])
    geometry, cells = cell_geometry(mesh, points), eliminated(mesh)
    wanted = laplacian(mesh, geometry)[cells.order][:, cells.order].toarray()
    got = cells.matrix(mesh, geometry, gradients(mesh, geometry).cells).toarray()
    assert len(cells.order) == mesh.cells - 1
    np.testing.assert_allclose(got, wanted, atol=1e-13 * np.abs(wanted).max())


def test_trace_is_symmetric_and_positive_on_closed_fluxes(level):
    mesh, geometry, _ = level
    trace = NeumannLaplacian(mesh, geometry).trace()
    assert np.abs(trace - trace.T).max() < 1e-12 * np.abs(trace).max()
    count = len(trace)
    closed = np.eye(count)[:, 1:] - np.eye(count)[:, :1]  # all fluxes without a net one
    assert np.linalg.eigvalsh(closed.T @ trace @ closed).min() > 0


def test_pressure_that_a_wall_asks_for_against_its_definition():
    mesh = half_ball(650)
    points = mesh.points + 0.05 * np.sin(4 * mesh.points[:, [1, 2, 0]])
    geometry = cell_geometry(mesh, points)
    rate = np.random.default_rng(0).normal(size=len(mesh.owner) - mesh.inner_faces)
    rate[mesh.diaphragm_faces :] *= 1e-2  # of sliding only; its normal part is left out
    rate -= rate.mean()
    got = NeumannLaplacian(mesh, geometry).pressure(rate)
    wanted = pressure_beside_walls(mesh, geometry, rate)
    difference = got - wanted - (got - wanted).mean()
    assert np.abs(difference).max() < 1e-11 * np.abs(wanted).max()


def test_trace_against_its_definition():
    # On a bent mesh a flux acts on the cells below by 0.4 % of itself, where the trace follows from
    # two-point fluxes that err by a tenth; those of its answer that are not symmetric are left out.
    mesh = half_ball(650)
    points = mesh.points + 0.05 * np.sin(4 * mesh.points[:, [1, 2, 0]])
    geometry = cell_geometry(mesh, points)
    operator, count = NeumannLaplacian(mesh, geometry), mesh.diaphragm_faces
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    share = area / area.sum()
    closed = np.eye(count) - share[:, None]  # a unit through one face, back through all
    rate = np.zeros((count, len(mesh.owner) - mesh.inner_faces))
    rate[:, :count] = closed.T
    wall = np.array([on_walls(mesh, geometry, operator.pressure(row))[:count] for row in rate]).T
    wall = wall - (wall_distance(mesh, geometry) / area)[:, None] * closed
    wanted = -(wall - share @ wall)
    got = closed.T @ operator.trace() @ closed
    wanted = 0.5 * (wanted + wanted.T)
    assert np.linalg.norm(got - wanted) < 1e-3 * np.linalg.norm(wanted)


def test_rows_factor_the_operator(level):
    mesh, geometry, patch = level
    rows = LiquidInertia.of(NeumannLaplacian(mesh, geometry), patch, DENSITY).rows
    faces = mesh.patch_faces
    flux = np.zeros((len(faces), *patch.shape))
    np.add.at(flux, (np.arange(len(faces))[:, None], faces), swept_gradient(patch[faces]))
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    operator = DENSITY * mean @ NeumannLaplacian(mesh, geometry).trace() @ mean.T
    motion = np.random.default_rng(0).normal(size=(2, *patch.shape))
    flat = np.tensordot(rows, motion, axes=([1, 2], [1, 2]))
    swept = np.tensordot(flux, motion, axes=([1, 2], [1, 2]))
    expected = swept.T @ operator @ swept
    assert np.abs(flat.T @ flat - expected).max() < 1e-10 * np.abs(expected).max()


def test_force_is_the_pressure_on_what_the_faces_sweep(level):
    mesh, geometry, patch = level
    inertia = LiquidInertia.of(NeumannLaplacian(mesh, geometry), patch, DENSITY)
    acceleration = np.random.default_rng(1).normal(size=patch.shape)
    swept = swept_rows(patch, mesh.patch_faces)
    wanted = (swept.T @ inertia.pressure(acceleration)).reshape(-1, 3)
    force = inertia.force(acceleration)
    assert np.abs(force - wanted).max() < 1e-12 * np.abs(wanted).max()  # the same sums, reordered
    assert np.vdot(force, acceleration) > 0.0


def test_uniform_lift_has_no_inertia(level):
    # It is the volume constraint's business: a mean pressure is removed, and a net flux too.
    mesh, geometry, patch = level
    rows = LiquidInertia.of(NeumannLaplacian(mesh, geometry), patch, DENSITY).rows
    lift = np.zeros_like(patch)
    lift[:, 2] = 1.0
    tilt = lift * patch[:, :1]
    size = np.linalg.norm(np.tensordot(rows, tilt, 2))
    # A row of the mean times areas: the face means of a uniform lift are the areas themselves.
    assert np.linalg.norm(np.tensordot(rows, lift, 2)) < 1e-10 * size


def test_half_cell_is_the_distance_to_the_wall(level):
    mesh, geometry, _ = level
    distance = wall_distance(mesh, geometry)
    below = -geometry.centre[mesh.owner[mesh.diaphragm], 2]
    assert distance == pytest.approx(below, abs=1e-12)
    assert distance.min() > 0


def sloshing(cells):
    """Lowest omega^2 R/g of the surface with this operator and gravity, on the faces' means."""
    mesh = half_ball(cells)
    size = (2 * np.pi / 3 / cell_geometry(mesh, mesh.points).volume.sum()) ** (1 / 3)
    geometry = cell_geometry(mesh, size * mesh.points)
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    trace = NeumannLaplacian(mesh, geometry).trace()
    basis = np.linalg.svd(area[None])[2][1:].T  # heights without volume
    weights = basis.T @ np.diag(area) @ basis
    inertia = basis.T @ (area[:, None] * trace * area) @ basis
    return float(eigh(weights, inertia, eigvals_only=True)[0])


def test_slosh_eigenvalue_converges_with_second_order():
    # McIver (1989): 1.560157 at h/R = 1. n = 4, 6, 8, 10 cells along an edge.
    counts, exact = np.array([4, 6, 8, 10]), 1.560157
    errors = np.array([abs(sloshing(c) - exact) / exact for c in (180, 550, 1300, 2400)])
    orders = np.log(errors[:-1] / errors[1:]) / np.log(counts[1:] / counts[:-1])
    assert (errors < 0.5 / counts**2).all()
    assert orders[-1] > 1.7
