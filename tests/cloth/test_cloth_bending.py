"""The bending energy is the plate's, whatever the shape, and vanishes as moulded."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse.linalg as spl

from cloth.bending import bending_of, carried_areas
from cloth.curvature import curvature_of, voronoi_areas
from cloth.flat import disc
from cloth.material import Diaphragm
from cloth.mesh import Mesh, border_nodes, hemisphere, lumped
from cloth.model import ClothModel
from cloth.step import Cloth

RUBBER = Diaphragm(density=1000.0, thickness=2e-3, youngs_modulus=9e6)


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


def per_area(mesh: Mesh, x: np.ndarray, up: np.ndarray, poisson: float) -> float:
    """Energy [J/m^2] at ``x``, of unit normals ``up``, above the moulded one; kappa = 3 N m."""
    bent = bending_of(mesh, np.full(len(x), 3.0), poisson)
    constant = bent.energy(mesh.points, curvature_of(mesh).normals)
    return (bent.energy(x, up) - constant) / carried_areas(mesh, np.zeros(len(x), dtype=bool)).sum()


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
@pytest.mark.parametrize(
    ("height", "k"),
    [
        (lambda x, y: 0.05 * x**2, (0.1, 0.0)),  # a cylinder
        (lambda x, y: 0.05 * (x * np.sqrt(0.5) + y * np.sqrt(0.5)) ** 2, (0.1, 0.0)),  # aslant
        (lambda x, y: 0.05 * (x**2 + y**2), (0.1, 0.1)),  # a sphere: kappa (1 + nu) k^2
        (lambda x, y: 0.05 * (x**2 - y**2), (0.1, -0.1)),  # a saddle: kappa (1 - nu) k^2
        (lambda x, y: 0.1 * x * y, (0.1, -0.1)),  # the same, twisted
    ],
)
def test_energy_of_a_plate_bent_both_ways(height, k, poisson):
    """kappa/2 (k1^2 + k2^2 + 2 nu k1 k2) per area, exactly: heights of degree two."""
    mesh = flat(12, 12)
    x = mesh.points.copy()
    x[:, 2] = height(x[:, 0], x[:, 1])
    exact = 1.5 * (k[0] ** 2 + k[1] ** 2 + 2.0 * poisson * k[0] * k[1])
    assert per_area(mesh, x, x, poisson) == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize(
    ("turned", "k"),
    [
        (0.0, (0.0, 0.0)),  # as moulded
        (np.inf, (-1.0, 0.0)),  # flattened
        (np.pi, (-2.0, 0.0)),  # rolled the other way
        (0.5 * np.pi, (-1.0, 1.0)),  # rolled across
    ],
)
def test_a_sheet_moulded_as_a_cylinder(turned, k, poisson):
    """Koiter's energy of rho = b - b0, in units of the moulded curvature 1/a.

    Chords for arcs are short by (h/a)^2/24 of the cells, twelve across an arc of half a radian.
    """

    def rolled(along: np.ndarray, sign: float) -> tuple[np.ndarray, np.ndarray]:
        """Points and normals of the sheet rolled up to a radius of 2 m along an axis."""
        along, other = (along, np.roll(along, 1))
        plan = square.points[:, :2]
        s, a = plan @ along, 2.0
        curl = np.stack([a * np.sin(s / a), sign * a * (np.cos(s / a) - 1.0)], axis=1)
        up = np.stack([np.sin(s / a) * sign, np.cos(s / a)], axis=1)
        position, normal = np.zeros_like(square.points), np.zeros_like(square.points)
        position[:, :2] = curl[:, :1] * along + (plan @ other)[:, None] * other
        position[:, 2] = curl[:, 1]
        normal[:, :2], normal[:, 2] = up[:, :1] * along, up[:, 1]
        return position, normal

    square = flat(12, 12)
    x_axis, y_axis = np.eye(2)
    moulded, _ = rolled(x_axis, 1.0)
    mesh = Mesh(
        points=moulded, triangles=square.triangles, fixed=square.fixed,
        rim_distance=square.rim_distance,
    )  # fmt: skip
    if turned == np.inf:
        x, up = square.points, np.tile([0.0, 0.0, 1.0], (len(moulded), 1))
    else:
        x, up = rolled(
            y_axis if turned == 0.5 * np.pi else x_axis, -1.0 if turned == np.pi else 1.0
        )
    exact = 1.5 / 2.0**2 * (k[0] ** 2 + k[1] ** 2 + 2.0 * poisson * k[0] * k[1])
    error = (1.0 / 24.0) ** 2 / 6.0  # of a second difference's angle, and as much of each length
    assert per_area(mesh, x, up, poisson) == pytest.approx(exact, rel=4.0 * error, abs=1e-9)


def test_wrinkles_converge_on_an_irregular_mesh():
    """kappa/2 k^4 sin(k x)^2 per area. Where neighbours are uneven the Laplacian errs at random by
    the unevenness, whatever the grid: its square, 1 % for nodes off by 10 % of a cell, remains."""
    errors = []
    for n in (24, 48):
        mesh = flat(n, n, jitter=0.1)
        bent = bending_of(mesh, np.ones(len(mesh.points)), 0.3)
        x = np.sin(4.0 * np.pi * mesh.points[:, 0])
        area = carried_areas(mesh, np.zeros(len(x), dtype=bool))
        exact = 0.5 * (4.0 * np.pi) ** 4 * area @ x**2
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


@pytest.mark.parametrize("clamped", [False, True])
def test_moulded_shape_is_at_rest(clamped):
    mesh = hemisphere(0.5, 16)
    model = Cloth(mesh=mesh, diaphragm=RUBBER, clamped_rim=clamped).model
    rest = np.abs(model.bending.matrix @ mesh.points).max()
    assert np.abs(model.bending_force(mesh.points)).max() <= 1e-10 * rest


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_mirrored_hemisphere(poisson):
    """8 pi (1 + nu) kappa above the moulded one, of any radius; the grid's error is O(h^2)."""
    errors = []
    for rings in (8, 16):
        mesh = hemisphere(0.5, rings)
        mirrored = mesh.points * [1.0, 1.0, -1.0]
        up = mirrored * [-1.0, -1.0, -1.0] / 0.5  # towards the gas
        area = 2.0 * np.pi * 0.5**2
        errors.append(per_area(mesh, mirrored, up, poisson) * area / 3.0)
    errors = np.array(errors) / (8.0 * np.pi * (1.0 + poisson)) - 1.0
    assert abs(errors[1]) < 0.01
    assert abs(errors[1]) < 0.4 * abs(errors[0])


def bent_hemisphere(shape: str, *, clamped: bool, held: bool) -> tuple[ClothModel, np.ndarray]:
    """A hemisphere with its rim ``held`` or free, and where its nodes are."""
    mesh = hemisphere(0.5, 6)
    if not held:
        mesh = replace(mesh, fixed=np.zeros_like(mesh.fixed))
    model = Cloth(mesh=mesh, diaphragm=RUBBER, clamped_rim=clamped).model
    x = mesh.points * [1.0, 1.0, -1.0 if shape == "mirrored" else 1.0]
    if shape == "crumpled":  # by a third of an edge, so that edges stretch and normals lean
        x = x + 0.03 * model.free[:, None] * np.random.default_rng(3).standard_normal(x.shape)
    return model, x


@pytest.mark.parametrize(("clamped", "held"), [(False, False), (False, True), (True, True)])
@pytest.mark.parametrize("shape", ["mirrored", "crumpled"])
def test_force_is_the_energys_derivative(shape, clamped, held):
    """By central differences with steps h and 2 h along random ways.

    Their error is c h^2 + O(h^4), a third of the two results' difference; the bound is that and as
    much again, and eps E/h of rounding.
    """
    model, x = bent_hemisphere(shape, clamped=clamped, held=held)
    force = model.bending_force(x)

    def energy(at: np.ndarray) -> float:
        _, gradient = model.volume_and_gradient(at)
        size = np.linalg.norm(gradient, axis=1)
        return model.bending.energy(at, gradient / np.where(size > 0.0, size, 1.0)[:, None])

    rng, step = np.random.default_rng(2), 1e-5
    for _ in range(6):
        way = np.where(model.free[:, None], rng.standard_normal(x.shape), 0.0)
        fine, coarse = (
            (energy(x + h * way) - energy(x - h * way)) / (2.0 * h) for h in (step, 2.0 * step)
        )
        truncation = abs(coarse - fine) / 3.0
        rounding = 10.0 * np.finfo(float).eps * np.abs(x * (model.bending.matrix @ x)).sum() / step
        assert truncation + rounding < 1e-5 * abs(fine)
        assert abs(fine + float(np.vdot(force, way))) < 2.0 * truncation + rounding


def test_force_of_a_free_sheet_has_no_resultant():
    """Neither force nor moment, however crumpled: the energy does not change by a rigid motion."""
    model, x = bent_hemisphere("crumpled", clamped=False, held=False)
    force = model.bending_force(x)
    rounding = 1e-12 * np.abs(model.bending.matrix @ x).sum()
    assert np.abs(force.sum(axis=0)).max() < rounding
    assert np.abs(np.cross(x, force).sum(axis=0)).max() < rounding * np.abs(x).max()
    assert np.linalg.norm(force, axis=1).max() > 1e6 * rounding


@pytest.mark.parametrize("poisson", [0.0, 0.5])
@pytest.mark.parametrize("clamped", [False, True])
def test_round_plate_under_even_pressure(clamped, poisson):
    """p a^4/(64 kappa) in the middle, simply supported (5 + nu)/(1 + nu) times that.

    Timoshenko and Woinowsky-Krieger, "Theory of Plates and Shells" (1959), section 16. The errors
    are of second order: a quarter at half the spacing, here with a margin.
    """
    errors = []
    for rings in (8, 16):
        mesh = disc(1.0, rings, 4 * rings)
        bent = bending_of(mesh, np.ones(len(mesh.points)), poisson, clamped=clamped)
        free, exact = ~mesh.fixed, (1.0 if clamped else (5.0 + poisson) / (1.0 + poisson)) / 64.0
        deflection = spl.spsolve(bent.matrix[free][:, free], lumped(mesh)[free])
        errors.append(abs(deflection[0] / exact - 1.0))
    assert errors[1] < 0.02
    assert errors[1] < 0.35 * errors[0]


def test_a_clamped_rim_must_stand_as_moulded():
    mesh = disc(1.0, 4, 12)
    with pytest.raises(ValueError, match="clamped rim"):
        Cloth(mesh=mesh, diaphragm=RUBBER, position=0.9 * mesh.points, clamped_rim=True)


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
