"""The liquid's kinetic energy: exact flows, the gradient by the shape, one Lagrangian."""

import numpy as np
import pytest

from coupling.foam.geometry import cell_geometry, fan_volume
from coupling.foam.mesh import half_ball
from coupling.interface import swept_gradient
from coupling.inviscid.lagrangian import kinetic_gradient
from coupling.inviscid.operator import ball_trace, boundary_integrals, closed_trace
from coupling.inviscid.panels import FINE, rule
from coupling.inviscid.surface import (
    area_vectors,
    liquid_momentum,
    surface_pressure,
    surface_speed,
)
from coupling.inviscid.symmetric import SymmetricTrace
from coupling.verify.disc import disc_grid
from coupling.verify.prism import prism_mesh, prism_panels

DENSITY = 1000.0


def sheet(cells, dent=0.15):
    """A dented sheet in the unit ball, its border on the equator: points, faces."""
    mesh = half_ball(cells)
    points = mesh.points[mesh.patch_points].copy()
    inside = 1 - np.minimum((points**2).sum(axis=1), 1.0)
    points[:, 2] = dent * inside * (np.cos(3 * points[:, 0]) + points[:, 1] - 1.5)
    return points, mesh.patch_faces


SOURCES = np.array([(0.2, 0.1, 0.6), (-0.3, 0.2, 0.7)])  # above the sheet, of opposite strength


def exact(x):
    """Potential (...,) and velocity (..., 3) of two sources in the gas, the wall being tight."""
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


def exact_flux(points, faces):
    at, area = rule(faces.shape[1], FINE).sample(points[faces])
    return np.sum(exact(at)[1] * area, axis=(1, 2))


def potential_error(cells, triangles=False):
    points, faces = sheet(cells)
    if triangles:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    flux = exact_flux(points, faces)
    got = ball_trace(points, faces, radius=1.0) @ flux
    wanted = exact(points[faces].mean(axis=1))[0]
    area = np.linalg.norm(area_vectors(points[faces]), axis=1)
    got, wanted = (phi - area @ phi / area.sum() for phi in (got, wanted))
    return np.sqrt(area @ (got - wanted) ** 2 / (area @ wanted**2))


@pytest.mark.parametrize("triangles", [False, True])
def test_potential_of_an_exact_flow_below_a_curved_sheet(triangles):
    # n = 4, 6, 10 cells along an edge: second order on a smooth sheet.
    errors = np.array([potential_error(cells, triangles) for cells in (180, 550, 2400)])
    assert errors[-1] < 0.02
    assert np.log(errors[0] / errors[-1]) / np.log(10 / 4) > 1.6


def closed_error(faces):
    """Of the kinetic energy of a harmonic flow in a cylinder of radius and depth 1."""
    plan, quads = disc_grid(faces)
    points, panels = prism_panels(plan, quads, 1.0)
    at, area = rule(4, FINE).sample(points[panels])
    x, y, z = np.moveaxis(at, -1, 0)
    potential = x**2 - z**2 + y * z
    velocity = np.stack([2 * x, z, y - 2 * z], axis=-1)
    flux = np.sum(velocity * area, axis=(1, 2))
    wanted = np.sum(potential[..., None] * velocity * area)  # int phi u.n, both as they are
    return abs(flux @ closed_trace(points, panels) @ flux / wanted - 1)


def test_energy_of_an_exact_flow_in_a_closed_cylinder():
    # n = 4, 6, 10 cells along the square's edge. Edges cost part of the second order: 1.44 is seen.
    errors = np.array([closed_error(faces) for faces in (64, 132, 340)])
    assert errors[-1] < 0.02
    assert np.log(errors[0] / errors[-1]) / np.log(10 / 4) > 1.3


def test_prism_is_closed_and_its_mesh_fills_it():
    plan, quads = disc_grid(132)
    points, panels = prism_panels(plan, quads, 0.7)
    area = area_vectors(points[panels])
    assert area.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-14)
    assert fan_volume(points[panels]) == pytest.approx(0.7 * np.pi, rel=1e-12)
    mesh = prism_mesh(700, 0.7)
    geometry = cell_geometry(mesh, mesh.points)
    assert geometry.volume.min() > 0
    assert geometry.volume.sum() == pytest.approx(0.7 * np.pi, rel=1e-12)
    top = geometry.face_area[mesh.diaphragm]
    assert top[:, 2].min() > 0
    assert top[:, 2].sum() == pytest.approx(np.pi, rel=1e-12)


def test_speed_and_momentum_of_an_exact_flow():
    points, faces = sheet(2400)
    flux = exact_flux(points, faces)
    phi = ball_trace(points, faces, radius=1.0) @ flux
    speed = surface_speed(points, faces, flux, phi)
    wanted = np.sum(exact(points[faces].mean(axis=1))[1] ** 2, axis=1)
    assert np.abs(speed - wanted).max() < 0.15 * wanted.max()  # gradients of first order, h = 0.1
    # The same momentum as the integral of phi n, here over a wall that the operator never saw.
    node, weight = np.polynomial.legendre.leggauss(40)
    z, angle = (node - 1) / 2, np.linspace(0, 2 * np.pi, 80, endpoint=False)
    across = np.sqrt(1 - z**2)[:, None]
    wall = np.stack(np.broadcast_arrays(across * np.cos(angle), across * np.sin(angle), z[:, None]))
    wall = np.moveaxis(wall, 0, -1)
    share = np.broadcast_to((weight / 2)[:, None] * 2 * np.pi / 80, wall.shape[:2])
    at, area = rule(4, FINE).sample(points[faces])
    total = np.einsum("tp,tp,tpx->x", share, exact(wall)[0], wall)
    total += np.einsum("fq,fqx->x", exact(at)[0], area)
    got = liquid_momentum(points, faces, flux, 1.0)
    assert np.abs(got - total).max() < 0.01 * np.abs(total).max()


def test_pressure_of_an_exact_unsteady_flow():
    points, faces = sheet(2400, dent=0.0)
    potential, velocity = exact(points[faces].mean(axis=1))
    strength, growth = 0.7, 1.3
    # Points that go with the liquid, and sideways beside it, as far as the sheet is flat.
    moving = strength * exact(points)[1] + np.array([0.4, -0.2, 0.0])
    mean = moving[faces].mean(axis=1)
    rate = growth * potential + strength * np.sum(mean * velocity, axis=1)
    got = surface_pressure(points, faces, moving, strength * potential, rate, DENSITY)
    wanted = -growth * potential - 0.5 * strength**2 * np.sum(velocity**2, axis=1)
    # Gradients of first order: h = 0.1 times the curvature of the potential.
    assert np.abs(got / DENSITY - wanted).max() < 0.05 * np.abs(wanted).max()
    assert np.abs(growth * potential + wanted).max() > 0.2 * np.abs(wanted).max()


@pytest.mark.parametrize("corners", [4, 3])
@pytest.mark.parametrize("clearance", [0.0, 0.05])
def test_gradient_is_the_derivative_of_the_discrete_energy(corners, clearance):
    random = np.random.default_rng(1)
    points, faces = sheet(180)
    points += 0.01 * random.normal(size=points.shape)
    if corners == 3:
        faces = np.concatenate([faces[:, [0, 1, 2]], faces[:, [0, 2, 3]]])
    velocity = random.normal(size=points.shape)

    def kinetic(at):
        return kinetic_gradient(
            at, faces, velocity,
            radius=1.0, wall_share=0.5, clearance=clearance, density=DENSITY,
        )  # fmt: skip

    found = kinetic(points)
    trace = ball_trace(points, faces, radius=1.0, wall_share=0.5, clearance=clearance)
    energy = 0.5 * DENSITY * found.flux @ trace @ found.flux
    assert found.energy == pytest.approx(energy, rel=1e-12)
    step = 1e-6
    for _ in range(3):
        way = random.normal(size=points.shape)
        ahead, behind = kinetic(points + step * way), kinetic(points - step * way)
        difference = (ahead.energy - behind.energy) / (2 * step)
        # Rounding of the energy over the step, and the step's square.
        assert np.sum(found.gradient * way) == pytest.approx(difference, rel=1e-7, abs=1e-6)


def test_gradient_of_a_sheet_folded_on_itself_and_pressed_on_the_shell():
    random = np.random.default_rng(2)
    mesh = half_ball(180)
    points = mesh.moulded * (0.99, 0.99, -0.99)
    points[:, 0] *= np.where(np.abs(points[:, 1]) < 0.3, 0.05, 1.0)  # folded nearly flat
    velocity, way = random.normal(size=(2, *points.shape))
    known = {"radius": 1.0, "wall_share": 0.5, "clearance": 0.02, "density": DENSITY}

    def energy(shift):
        return kinetic_gradient(points + shift * way, mesh.patch_faces, velocity, **known).energy

    found = kinetic_gradient(points, mesh.patch_faces, velocity, **known)
    integrals = boundary_integrals(
        points, mesh.patch_faces, radius=1.0, wall_share=0.5, clearance=0.02
    )
    assert SymmetricTrace(integrals.single, integrals.double).limited  # or it would test nothing
    difference = (energy(1e-6) - energy(-1e-6)) / 2e-6
    assert np.sum(found.gradient * way) == pytest.approx(difference, rel=1e-5)


class HeavingSheet:
    """A few vertical modes of large amplitude, under gravity: Hamilton's equations, RK4.

    Heights over a fixed plan: the volume is linear in them, and every mode keeps it exactly.
    """

    def __init__(self, *, with_gradient):
        mesh = half_ball(180)
        self.plan, self.faces = mesh.points[mesh.patch_points], mesh.patch_faces
        x, y = self.plan[:, 0], self.plan[:, 1]
        inside = 1 - np.minimum(x**2 + y**2, 1.0)
        lift = np.zeros_like(self.plan)
        np.add.at(lift, self.faces, swept_gradient(self.plan[self.faces]))
        self.weight = lift[:, 2]
        shapes = inside * np.array([x, y + x**2, 4 * (x**2 + y**2) - 1])
        shapes -= inside * (shapes @ self.weight / (inside @ self.weight))[:, None]
        self.modes = np.zeros((3, *self.plan.shape))
        self.modes[:, :, 2] = shapes
        self.stiffness = 5.0 * DENSITY * (shapes * self.weight) @ shapes.T
        self.with_gradient = with_gradient

    def kinetic(self, amplitude, velocity):
        points = self.plan + np.tensordot(amplitude, self.modes, 1)
        return kinetic_gradient(
            points, self.faces, np.tensordot(velocity, self.modes, 1),
            radius=1.0, wall_share=0.5, clearance=0.01, density=DENSITY,
        )  # fmt: skip

    def velocity(self, amplitude, momentum):
        points = self.plan + np.tensordot(amplitude, self.modes, 1)
        corner = swept_gradient(points[self.faces])
        flux = np.einsum("fkx,mfkx->fm", corner, self.modes[:, self.faces])
        trace = ball_trace(points, self.faces, radius=1.0, wall_share=0.5, clearance=0.01)
        mass = DENSITY * flux.T @ trace @ flux
        return np.linalg.solve(mass, momentum)

    def rate(self, state):
        amplitude, momentum = state
        velocity = self.velocity(amplitude, momentum)
        force = -self.stiffness @ amplitude
        if self.with_gradient:
            gradient = self.kinetic(amplitude, velocity).gradient
            force = force + np.tensordot(self.modes, gradient, 2)
        return np.array([velocity, force])

    def energy(self, state):
        amplitude, momentum = state
        kinetic = 0.5 * momentum @ self.velocity(amplitude, momentum)
        return kinetic + 0.5 * amplitude @ self.stiffness @ amplitude

    def drift(self, steps, duration=1.6):
        """Largest relative change of the energy over ``duration`` [s]."""
        state = np.array([[0.9, 0.5, 0.4], [0.0, 0.0, 0.0]])
        start, dt = self.energy(state), duration / steps
        worst = 0.0
        for _ in range(steps):
            a = self.rate(state)
            b = self.rate(state + dt / 2 * a)
            c = self.rate(state + dt / 2 * b)
            d = self.rate(state + dt * c)
            state = state + dt / 6 * (a + 2 * b + 2 * c + d)
            worst = max(worst, abs(self.energy(state) / start - 1))
        return worst


def test_a_changing_shape_creates_no_energy_with_the_gradient_alone():
    exact_force, missing = (HeavingSheet(with_gradient=yes) for yes in (True, False))
    coarse, fine = exact_force.drift(20), exact_force.drift(40)
    assert fine < 1e-4
    assert np.log2(coarse / fine) > 3.5  # the integrator's fourth order, and nothing else
    drifts = missing.drift(20), missing.drift(40)
    assert min(drifts) > 1000 * fine  # no step is small enough
    assert drifts[0] == pytest.approx(drifts[1], rel=0.2)
