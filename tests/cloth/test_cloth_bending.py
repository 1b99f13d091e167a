"""The bending energy is the plate's, whatever the shape, and vanishes as moulded."""

from __future__ import annotations

import numpy as np
import pytest

from cloth.bending import Bending, bending_of, voronoi_areas
from cloth.material import Diaphragm
from cloth.mesh import Mesh, border_nodes, hemisphere, lumped
from cloth.step import Cloth


def energy(bent: Bending, x: np.ndarray, normals: np.ndarray, weight: np.ndarray) -> float:
    """1/2 sum |K x - c n|^2 weight, spelled out."""
    k = np.zeros((len(x), len(x)))
    for i in range(len(x)):
        span = slice(bent.starts[i], bent.starts[i + 1])
        k[i, bent.columns[span]] = bent.values[span]
    curvature = np.divide(bent.moment, weight, out=np.zeros_like(weight), where=weight > 0.0)
    return 0.5 * float(weight @ np.sum((k @ x - curvature[:, None] * normals) ** 2, axis=1))


def flat(nx: int, ny: int, jitter: float = 0.0) -> Mesh:
    """A unit square of slanted triangles, its inner nodes moved at random."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, nx + 1), np.linspace(0.0, 1.0, ny + 1))
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(ny)[:, None] * (nx + 1) + np.arange(nx)).ravel()
    a, b, c, d = corner, corner + 1, corner + nx + 2, corner + nx + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    inner = np.ones(len(points), dtype=bool)
    inner[border_nodes(triangles)] = False
    moves = np.random.default_rng(1).uniform(-jitter, jitter, (len(points), 2))
    points[inner, :2] += moves[inner] / nx
    none = np.zeros(len(points), dtype=bool)
    return Mesh(points=points, triangles=triangles, fixed=none, rim_distance=np.ones(len(points)))


@pytest.mark.parametrize(
    ("height", "twice_mean"),
    [
        (lambda x, y: 0.05 * x**2, 0.1),  # a cylinder: kappa k^2/2
        (lambda x, y: 0.05 * (x * np.sqrt(0.5) + y * np.sqrt(0.5)) ** 2, 0.1),  # the same, aslant
        (lambda x, y: 0.05 * (x**2 + y**2), 0.2),  # a sphere: 2 kappa k^2
        (lambda x, y: 0.05 * (x**2 - y**2), 0.0),  # a saddle: none
    ],
)
def test_energy_of_a_plate_bent_both_ways(height, twice_mean):
    """kappa/2 (2H)^2 per area, exactly: heights of degree two on a regular grid."""
    mesh = flat(12, 12)
    bent = bending_of(mesh, np.full(len(mesh.points), 3.0))
    x = mesh.points.copy()
    x[:, 2] = height(x[:, 0], x[:, 1])
    inner = np.ones(len(x), dtype=bool)
    inner[border_nodes(mesh.triangles)] = False
    area = voronoi_areas(mesh)[inner].sum()
    got = 0.5 * x[:, 2] @ bent.matrix @ x[:, 2]
    assert got == pytest.approx(0.5 * 3.0 * twice_mean**2 * area, rel=1e-9, abs=1e-12)


def test_wrinkles_converge_on_an_irregular_mesh():
    """kappa/2 k^4 sin(k x)^2 per area. Where neighbours are uneven the Laplacian errs at random by
    the unevenness, whatever the grid: its square, 1 % for nodes off by 10 % of a cell, remains."""
    errors = []
    for n in (24, 48):
        mesh = flat(n, n, jitter=0.1)
        bent = bending_of(mesh, np.ones(len(mesh.points)))
        x = np.sin(4.0 * np.pi * mesh.points[:, 0])
        inside = np.ones(len(x), dtype=bool)
        inside[border_nodes(mesh.triangles)] = False
        exact = 0.5 * (4.0 * np.pi) ** 4 * voronoi_areas(mesh)[inside] @ x[inside] ** 2
        errors.append(0.5 * x @ bent.matrix @ x / exact - 1.0)
    coarse = -((4.0 * np.pi / 24) ** 2) / 6.0  # of the second difference, twice over
    assert abs(errors[0] - coarse) < 0.015
    assert abs(errors[1] - coarse / 4.0) < 0.015


def test_voronoi_areas_tile_the_sheet():
    mesh = hemisphere(1.0, 9)
    assert voronoi_areas(mesh).sum() == pytest.approx(lumped(mesh).sum(), rel=1e-12)
    corner = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [-2.0, 0.5, 0.0]])  # obtuse at the first
    one = Mesh(
        points=corner, triangles=np.array([[0, 1, 2]]), fixed=np.zeros(3, dtype=bool),
        rim_distance=np.ones(3),
    )  # fmt: skip
    np.testing.assert_allclose(voronoi_areas(one), [0.125, 0.0625, 0.0625], rtol=1e-12)


def test_moulded_shape_is_at_rest_and_its_mirror_bent_by_twice_the_curvature():
    """Everted, every node is bent by twice 2/R: 8 kappa/R^2 per area, within the mesh's O(h^2)."""
    mesh = hemisphere(0.5, 16)
    sheet = Diaphragm(density=1000.0, thickness=2e-3, youngs_modulus=9e6)
    model = Cloth(mesh=mesh, diaphragm=sheet).model
    rest = np.abs(model.bending.matrix @ mesh.points).max()
    assert np.abs(model.bending_force(mesh.points)).max() <= 1e-10 * rest
    weight = np.zeros(len(mesh.points))
    inner = ~mesh.fixed
    weight[inner] = sheet.bending_stiffness / voronoi_areas(mesh)[inner]
    mirror = mesh.points * [1.0, 1.0, -1.0]
    up = mirror * [-1.0, -1.0, -1.0] / 0.5  # towards the gas
    got = energy(model.bending, mirror, up, weight)
    area = voronoi_areas(mesh)[inner].sum()
    assert got == pytest.approx(8.0 * sheet.bending_stiffness / 0.5**2 * area, rel=0.02)


def test_thickness_of_each_triangle_enters_mass_and_stiffness():
    """Twice the thickness on one half: twice the mass, eight times the bending stiffness there."""
    mesh = flat(8, 8)
    sheet = Diaphragm(density=1000.0, thickness=1e-3, youngs_modulus=1e7)
    thick = np.where(mesh.points[mesh.triangles][:, :, 0].mean(axis=1) > 0.5, 2e-3, 1e-3)
    even, uneven = (Cloth(mesh=mesh, diaphragm=sheet, thickness=t).model for t in (None, thick))
    x = mesh.points[:, 0]
    np.testing.assert_allclose(uneven.mass[x < 0.45], even.mass[x < 0.45])
    np.testing.assert_allclose(uneven.mass[x > 0.55], 2.0 * even.mass[x > 0.55])
    for side, factor in ((x < 0.3, 1.0), (x > 0.7, 8.0)):
        np.testing.assert_allclose(
            uneven.bending.matrix.diagonal()[side], factor * even.bending.matrix.diagonal()[side]
        )
    assert uneven.mass.sum() == pytest.approx(1.5 * even.mass.sum())
