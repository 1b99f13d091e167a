"""The boundary-element liquid: its kernel, its compiled integrals, and the operator they give."""

import numpy as np
import pytest

from coupling.foam.added_mass import neumann_trace
from coupling.foam.geometry import cell_geometry
from coupling.foam.mesh import half_ball
from coupling.inviscid.kernels import TINY, image, rounded
from coupling.inviscid.operator import ball_trace, boundary_integrals
from coupling.inviscid.panels import COARSE, FINE, kept_off, rule, topology

RADIUS = 0.4445


def neumann_function(x, y, radius):
    """4 pi G as the literature writes it."""
    xy, xx, yy = np.sum(x * y, -1), np.sum(x * x, -1), np.sum(y * y, -1)
    s = np.sqrt(radius**2 - 2 * xy + xx * yy / radius**2)
    log = np.log(2 * radius**2 / (radius**2 - xy + radius * s))
    return 1 / np.linalg.norm(x - y, axis=-1) + 1 / s + log / radius


def sheet(cells=550, level=-0.1, dent=0.12):
    """A dented sheet across the ball, its border on the shell: points, faces, wetted share."""
    mesh = half_ball(cells)
    plan = mesh.points[mesh.patch_points]
    points = np.sqrt(1 - level**2) * plan
    inside = 1 - np.minimum((plan**2).sum(axis=1), 1.0)
    points[:, 2] = level + dent * inside * (np.cos(3 * plan[:, 0]) + plan[:, 1])
    return RADIUS * points, mesh.patch_faces, (1 + level) / 2


def reference(points, faces, radius, row_sum):
    """The two operators in plain NumPy: the definition of the compiled ones."""
    corner = points[faces]
    centre, touching = corner.mean(axis=1), topology(faces, len(points)).touching
    count = len(faces)
    single, double = np.zeros((2, count, count))
    for chosen, number in ((~touching, COARSE), (touching, FINE)):
        y, n = rule(faces.shape[1], number).sample(corner)
        area = np.sqrt(np.sum(n**2, axis=2) + (TINY * radius) ** 4)
        disc = np.sqrt(area / np.pi)
        x = centre[:, None, None, :]
        away = x - y
        r = np.linalg.norm(away, axis=-1)
        r = np.where(r < disc, (disc + r**2 / disc) / 2, r)
        free = ~np.eye(count, dtype=bool)[:, :, None]
        s_part = free * area / r
        d_part = free * np.sum(n * away, axis=-1) / r**3
        xx, xy, yy = np.sum(x * x, -1), np.sum(x * y, -1), np.sum(y * y, -1)
        s = np.sqrt(radius**2 - 2 * xy + xx * yy / radius**2)
        s = np.where(s < disc, (disc + s**2 / disc) / 2, s)
        reach = radius**2 - xy + radius * s
        s_part = s_part + area * (1 / s + np.log(2 * radius**2 / reach) / radius)
        slope = (xx[..., None] / radius**2 * y - x) / s[..., None]
        slope = -slope / s[..., None] ** 2 - (slope - x / radius) / reach[..., None]
        d_part = d_part + np.sum(n * slope, axis=-1)
        fine = rule(faces.shape[1], FINE).sample(corner)[1]
        size = np.sqrt(np.sum(fine**2, axis=2) + (TINY * radius) ** 4).sum(axis=1)
        single += chosen * s_part.sum(axis=2) / size
        double += chosen * d_part.sum(axis=2)
    a, b = corner - centre[:, None], np.roll(corner, -1, axis=1) - centre[:, None]
    edge = np.linalg.norm(b - a, axis=2)
    sides = np.linalg.norm(a, axis=2) + np.linalg.norm(b, axis=2)
    own = np.linalg.norm(np.cross(a, b), axis=2) / edge
    own = (own * np.log((sides + edge) / (sides - edge))).sum(axis=1)
    own += 2 * np.sqrt(np.pi * fine.shape[1]) * TINY * radius
    single[np.diag_indices(count)] += own / size
    single, double = single / (4 * np.pi), double / (4 * np.pi)
    np.fill_diagonal(double, 0.0)
    np.fill_diagonal(double, row_sum - double.sum(axis=1))
    return single, double


def test_kernel_is_the_neumann_function_of_the_ball():
    random = np.random.default_rng(0)
    x, y = 0.5 * random.uniform(-1, 1, (2, 20, 3))
    normal = random.normal(size=(20, 3))
    normal /= np.linalg.norm(normal, axis=1)[:, None]

    def ours(x, y, n):
        r2 = (x - y) @ (x - y)
        value, slope = image(x @ x, x @ y, y @ y, n @ x, n @ y, 0.0, 1.1)
        return 1 / np.sqrt(r2) + value, n @ (x - y) / r2**1.5 + slope

    step = 1e-5
    for a, b, n in zip(x, y, normal, strict=True):
        value, slope = ours(a, b, n)
        assert value == pytest.approx(neumann_function(a, b, 1.1), rel=1e-13)
        ahead, behind = (neumann_function(a, b + k * step * n, 1.1) for k in (1, -1))
        assert slope == pytest.approx((ahead - behind) / (2 * step), rel=1e-6, abs=1e-6)
        wall = 1.1 * n
        assert ours(a, wall, n)[1] == pytest.approx(-1 / 1.1**2, rel=1e-12)


def test_rounding_gives_the_potential_of_a_disc_at_its_centre():
    # A disc of radius b and charge 1 per area: 2 pi b; a point of the same charge: pi b^2 / r.
    assert np.pi * 0.3**2 / rounded(0.0, 0.3) == pytest.approx(2 * np.pi * 0.3)
    assert rounded(0.3**2, 0.3) == pytest.approx(0.3)


@pytest.mark.parametrize("corners", [4, 3])
def test_integrals_equal_their_definition(corners):
    points, faces, share = sheet()
    if corners == 3:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    got = boundary_integrals(points, faces, radius=RADIUS, wall_share=share, clearance=0.0)
    single, double = reference(points, faces, RADIUS, share - 0.5)
    assert np.abs(got.single - single).max() < 1e-13 * np.abs(single).max()
    assert np.abs(got.double - double).max() < 1e-12


def test_trace_is_symmetric_and_positive_on_closed_fluxes():
    points, faces, share = sheet()
    trace = ball_trace(points, faces, radius=RADIUS, wall_share=share)
    assert (trace == trace.T).all()
    closed = np.eye(len(faces))[:, 1:] - np.eye(len(faces))[:, :1]
    assert np.linalg.eigvalsh(closed.T @ trace @ closed).min() > 0


def test_trace_agrees_with_the_finite_volumes():
    """Both are of second order, so their difference is: n = 6 and 10 cells along an edge."""
    differences = []
    for cells in (550, 2400):
        mesh = half_ball(cells)
        geometry = cell_geometry(mesh, mesh.points)
        centre, area = geometry.face_centre[mesh.diaphragm], geometry.face_area[mesh.diaphragm]
        area = np.linalg.norm(area, axis=1)
        ours = ball_trace(mesh.points[mesh.patch_points], mesh.patch_faces, radius=1.0)
        theirs = neumann_trace(mesh, geometry)
        x, y = centre[:, 0], centre[:, 1]
        fluxes = (area * np.array([x, x * y, x**2 - y**2, x**3])).T
        both = [np.einsum("fk,fg,gk->k", fluxes, g, fluxes) for g in (ours, theirs)]
        differences.append(np.abs(both[0] / both[1] - 1))
    # x^2 - y^2 is the coarsest seen: each of its four lobes has a handful of faces.
    assert (differences[0] < np.array([1, 3, 4, 2]) / 36).all()
    assert (np.log(differences[0] / differences[1]) / np.log(10 / 6) > 1.6).all()


def test_film_keeps_off_the_shell_once_differentiably():
    radial = np.linspace(0.5, 1.0, 2001)[:, None] * np.array([[0.0, 0.6, -0.8]])
    edge = np.zeros(len(radial), dtype=bool)
    kept = np.linalg.norm(kept_off(radial, edge, 1.0, 0.02), axis=1)
    assert kept.max() == pytest.approx(0.98)
    assert kept[0] == pytest.approx(0.5)
    slope = np.diff(kept) / 2.5e-4
    assert slope.min() > -1e-9
    assert np.abs(np.diff(slope)).max() < 0.01  # a kink would show as a jump of one
    edge[:] = True
    assert kept_off(radial, edge, 1.0, 0.02) == pytest.approx(radial)


def test_trace_is_finite_and_positive_for_any_sheet():
    mesh = half_ball(550)
    faces, random = mesh.patch_faces, np.random.default_rng(1)
    down = mesh.moulded * (1.0, 1.0, -1.0)
    inner = ~mesh.rim
    shapes = {"on the shell": down, "level above the rest on the shell": down.copy()}
    shapes["level above the rest on the shell"][:, 2] = np.maximum(down[:, 2], -0.6)
    shapes["folded flat"] = down * np.where(np.abs(down[:, 1:2]) < 0.3, (0.05, 1.0, 1.0), 1.0)
    shapes["collapsed to a point"] = np.where(inner[:, None], 0.0, down)
    noise = random.normal(size=down.shape) * inner[:, None]
    shapes["through itself"] = down * (1.0, 1.0, 0.2) + 0.1 * noise
    shapes["through itself within a face"] = 0.7 * down + 0.3 * noise
    closed = np.linalg.qr(np.eye(len(faces))[:, 1:] - np.eye(len(faces))[:, :1])[0]
    for name, points in shapes.items():
        for clearance in (0.0, 0.01):
            trace = ball_trace(points, faces, radius=1.0, clearance=clearance)
            assert np.isfinite(trace).all(), name
            assert (trace == trace.T).all(), name
            assert np.linalg.eigvalsh(closed.T @ trace @ closed).min() > 0, name
