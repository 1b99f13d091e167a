"""Every compiled kernel against its NumPy definition, and the linear system against a dense one."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from cloth import kernels, node_kernels, node_reference, reference, triangle_kernels
from cloth.bending import bending_of
from cloth.factors import factor_of
from cloth.linear import System, stretch_matrix
from cloth.mesh import Mesh, corners_of, hemisphere, rest_gradients
from cloth.shell.sphere import Sphere

ROUNDING = 1e-11  # sums of a few hundred terms of order one, in another order


@pytest.fixture(scope="module")
def mesh() -> Mesh:
    return hemisphere(1.0, 5)


@pytest.fixture
def crumpled(mesh: Mesh) -> np.ndarray:
    return mesh.points + 0.08 * np.random.default_rng(3).standard_normal(mesh.points.shape)


@pytest.mark.parametrize(
    ("tensile", "compressive"), [(40.0, 0.0), (1e4, 10.0), (40.0, 5.0), (40.0, 40.0)]
)
@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize("strained", [False, True])
def test_triangle_step(mesh, crumpled, tensile, compressive, poisson, strained):
    rng = np.random.default_rng(4)
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    tensile, compressive = np.full(len(areas), tensile), np.full(len(areas), compressive)
    penalty = rng.uniform(50.0, 100.0, len(areas))
    slope = np.array([100.0, -30.0, -9810.0])
    z0, u0 = rng.normal(size=(2, len(areas), 3, 2)) * 0.1
    rest = rng.normal(size=(len(areas) if strained else 0, 3)) * 0.05
    corners, answers = corners_of(mesh.triangles, len(crumpled)), []
    for module in (reference, triangle_kernels):
        z, u, rhs, gradient = z0.copy(), u0.copy(), np.zeros_like(crumpled), np.empty_like(crumpled)
        cone = module.triangle_step(
            crumpled, mesh.triangles, *corners, gradients, areas, penalty, 1.4,
            tensile, compressive, poisson, rest, z, u, 700.0, slope, ~mesh.fixed, gradient, rhs,
        )  # fmt: skip
        answers.append((z, u, rhs, gradient, np.array(cone)))
    for wanted, got in zip(*answers, strict=True):
        np.testing.assert_allclose(got, wanted, atol=ROUNDING * np.abs(wanted).max())


def test_projection_of_equal_stretches_is_a_uniform_scaling(mesh):
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    z, u = np.zeros((2, len(areas), 3, 2))
    rhs, gradient = np.zeros((2, *mesh.points.shape))
    one = np.ones(len(areas))
    triangle_kernels.triangle_step(
        1.5 * mesh.points, mesh.triangles, *corners_of(mesh.triangles, len(mesh.points)),
        gradients, areas, one, 1.0, 1e15 * one, 0.0 * one, 0.5,
        np.empty((0, 3)), z, u, 0.0, np.zeros(3), ~mesh.fixed, gradient, rhs,
    )  # fmt: skip
    np.testing.assert_allclose(np.linalg.svd(z, compute_uv=False), 1.0, atol=1e-12)
    np.testing.assert_allclose(u, 0.5 * z, atol=1e-12)


def test_triangle_strains(mesh, crumpled):
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    wanted, got = np.empty((2, len(areas), 3))
    for module, strain in ((reference, wanted), (kernels, got)):
        module.triangle_strains(crumpled, mesh.triangles, gradients, strain)
    np.testing.assert_allclose(got, wanted, atol=1e-12)


def test_principal_strains(mesh, crumpled):
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    wanted, got = np.empty((2, len(areas)))
    worst = reference.principal_strains(crumpled, mesh.triangles, gradients, wanted)
    assert kernels.principal_strains(crumpled, mesh.triangles, gradients, got) == pytest.approx(
        worst, rel=1e-12
    )
    np.testing.assert_allclose(got, wanted, atol=1e-12)


def test_volume_and_gradient(mesh, crumpled):
    answers = []
    for module in (reference, kernels):
        gradient = np.empty_like(crumpled)
        cone = module.volume_and_gradient(crumpled, mesh.triangles, ~mesh.fixed, gradient)
        answers.append((np.array(cone), gradient))
    for wanted, got in zip(*answers, strict=True):
        np.testing.assert_allclose(got, wanted, atol=ROUNDING * np.abs(wanted).max())


@pytest.mark.parametrize("friction", [0.0, 0.3, 5.0])
def test_node_step(mesh, crumpled, friction):
    """Contact, bending's moulded part and the drag's normal part, one after the other."""
    rng = np.random.default_rng(5)
    n = len(crumpled)
    limit, weight = 0.95, np.where(mesh.fixed, 0.0, 3.0)
    drag = np.where(mesh.fixed, 0.0, rng.uniform(1.0, 2.0, n))
    bent = bending_of(mesh, np.ones(n), 0.5)
    damped = 1.7 * bent.moment
    gradient = rng.normal(size=crumpled.shape)
    gradient[3] = 0.0  # a node without a normal
    z0, u0 = rng.normal(size=(2, *crumpled.shape)) * 0.1
    z, u, wanted = z0.copy(), u0.copy(), np.zeros_like(crumpled)
    start = crumpled + 0.05 * rng.normal(size=crumpled.shape)
    rub, rubbed = np.ones((2, *crumpled.shape))
    node_reference.contact_step(crumpled, limit, weight, 1.3, friction, start, z, u, rubbed, wanted)
    node_reference.bending_rest_step(
        gradient, bent.starts, bent.columns, bent.values, damped, wanted
    )
    node_reference.bending_turning_step(
        crumpled, mesh.triangles, gradient,
        bent.starts, bent.columns, bent.values, bent.moment, wanted,
    )  # fmt: skip
    node_reference.normal_drag_step(crumpled, mesh.points, gradient, drag, wanted)
    got = np.zeros_like(crumpled)
    node_kernels.node_step(
        crumpled, Sphere(limit).profile, weight, 1.3, friction, start, z0, u0, rub, mesh.triangles,
        gradient, bent.starts, bent.columns, bent.values, bent.moment, damped,
        mesh.points, drag, got,
    )  # fmt: skip
    for right, answer in ((z, z0), (u, u0), (wanted, got)):
        np.testing.assert_allclose(answer, right, atol=ROUNDING * np.abs(right).max())
    np.testing.assert_allclose(rub, rubbed, atol=ROUNDING)
    assert np.any(rubbed) == (friction > 0.0)


@pytest.mark.parametrize("rank", [0, 1, 7, 40])
def test_system_against_a_dense_solve(mesh, rank):
    rng = np.random.default_rng(7)
    n = len(mesh.points)
    free = ~mesh.fixed
    bent = bending_of(mesh, np.ones(n), 0.5)
    matrix = sp.csc_matrix(bent.matrix + sp.diags(rng.uniform(1.0, 2.0, n)))
    rows = np.where(free[None, :, None], rng.normal(size=(rank, n, 3)), 0.0)
    system = System(matrix, free)
    system.add_mass(rows)
    right = rng.normal(size=(n, 3))
    flat = rows.reshape(rank, 3 * n)
    dense = np.kron(matrix.toarray(), np.eye(3)) + flat.T @ flat
    on = np.repeat(free, 3)
    wanted = np.zeros(3 * n)
    wanted[on] = np.linalg.solve(dense[np.ix_(on, on)], right.ravel()[on])
    got = system.solve(right)
    np.testing.assert_allclose(got.ravel(), wanted, atol=1e-10 * np.abs(wanted).max())
    fixed_at = rng.normal(size=(n, 3))
    lift = system.lift(fixed_at, mesh.fixed)
    np.testing.assert_allclose(
        lift[free], -matrix.toarray()[np.ix_(free, ~free)] @ fixed_at[mesh.fixed], atol=1e-12
    )


@pytest.mark.parametrize("columns", [1, 3, 7])
def test_blocks_of_the_factor_against_scipy(columns):
    """A grid's matrix, whose factor has blocks of many widths, on few and on three columns."""
    mesh = hemisphere(1.0, 12)
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    size = len(mesh.points)
    matrix = stretch_matrix(mesh.triangles, gradients, areas, size) + sp.eye(size, format="csc")
    found = spl.splu(
        sp.csc_matrix(matrix), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )  # fmt: skip
    lower = sp.csc_matrix(sp.tril(found.L, -1, format="csc"))
    lower.sort_indices()
    factor = factor_of(
        lower.indptr.astype(np.int64), lower.indices.astype(np.int64), lower.data,
        found.U.diagonal(),
    )  # fmt: skip
    assert np.diff(factor.heads).max() > 3
    assert np.diff(factor.heads).min() == 1
    right = np.random.default_rng(8).normal(size=(size, columns))
    got = np.empty_like(right)
    order = np.argsort(found.perm_c)
    got[order] = factor.solved(right[order], block=3)
    wanted = spl.spsolve(sp.csc_matrix(matrix), right).reshape(right.shape)
    np.testing.assert_allclose(got, wanted, atol=1e-12 * np.abs(wanted).max())
