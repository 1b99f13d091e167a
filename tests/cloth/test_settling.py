"""The rest that settling finds is one, by the sheet's energies and by the liquid's level."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from cloth.energy import stretch_energy
from cloth.level import level_shape
from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import hemisphere
from cloth.residual import residual, stress
from cloth.settle import settle
from cloth.shell.sphere import Sphere
from cloth.step import Cloth

WATER, GRAVITY = 997.0, 9.81


@dataclass(frozen=True)
class Water:
    volume: float | None
    body_force: np.ndarray
    datum: float | None = None
    recoil: None = None
    density: float = WATER
    turn: None = None


def tank(
    *, rings: int = 8, fill: float = 0.5, tilt: float = 0.0, radius: float = 0.4445,
    thickness: float = 1.778e-3, gravity: float = GRAVITY, resolved: bool = False,
    modulus: float = 8.6e6,
) -> tuple[Cloth, Water]:  # fmt: skip
    """A sheet that hardly stretches, relaxed unless ``resolved``; ``tilt`` [degrees]."""
    angle, unit = math.radians(tilt), WATER * gravity * radius**2
    rubber = diaphragm("AF-E-332", thickness, youngs_modulus=modulus)
    cloth = Cloth(
        mesh=hemisphere(radius, rings),
        diaphragm=rubber,
        shell=Sphere(radius),
        tensile_stiffness=None if resolved else 100.0 * unit,
        compressive_stiffness=None if resolved else 1e-3 * unit,
        self_contact=True,
        settings=Settings(bending_damping=5.0 * math.sqrt(radius / gravity)),
    )
    down = gravity * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    return cloth, Water(fill * 4.0 / 3.0 * math.pi * radius**3, down)


def centre(cloth: Cloth) -> np.ndarray:
    """Of gravity (3,) [m] of the liquid."""
    p = cloth.state.position[cloth.triangles]
    cone = np.einsum("td,td->t", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
    moment = (cone[:, None] * p.sum(axis=1) / 4.0).sum(axis=0)
    moment[2] -= 0.25 * math.pi * float(cloth.model.shell.size) ** 4
    return np.asarray(moment / cloth.state.volume)


def largest_motion(cloth: Cloth, load: Water, *, steps: int = 10, dt: float = 0.005) -> float:
    """Of a node from where it stands, over the radius, in time steps from rest."""
    before = cloth.state.position
    for _ in range(steps):
        cloth.begin_step(dt, load)
        cloth.solve(np.zeros_like(before))
        cloth.accept_step()
    return float(np.abs(cloth.state.position - before).max() / cloth.model.size)


@pytest.mark.parametrize("resolved", [False, True])
def test_stress_is_the_derivative_of_the_stretch_energy(resolved):
    """Central differences of 1e-7 R leave rounding of 1e-9 of the energy's own scale."""
    cloth, _ = tank(rings=6, resolved=resolved)
    model, rng = cloth.model, np.random.default_rng(0)
    x = model.mesh.points * [1.02, 0.9, 1.0] + 2e-3 * rng.standard_normal(model.mesh.points.shape)
    d = rng.standard_normal(x.shape)
    h = 1e-7 * model.size
    slope = (stretch_energy(model, x + h * d) - stretch_energy(model, x - h * d)) / (2.0 * h)
    change = np.einsum("tid,tie->tde", d[model.triangles], model.gradients)
    power = float(np.einsum("t,tde,tde->", model.areas, stress(model, x), change))
    # Terms of the compressive beside the tensile stiffness are left out of either: 1e-5.
    assert power == pytest.approx(slope, rel=1e-4)


def test_the_force_left_is_that_of_the_energies():
    """Forces by differences of energy and potential, node by node, off the shell."""
    cloth, load = tank(rings=6, fill=0.8)
    model, x = cloth.model, 0.97 * cloth.reference
    x[model.mesh.fixed] = cloth.reference[model.mesh.fixed]
    datum, slope, h = 300.0, WATER * load.body_force, 1e-6

    def energy(position: np.ndarray) -> float:
        p = position[cloth.triangles]
        cone = np.einsum("td,td->t", p[:, 0], np.cross(p[:, 1], p[:, 2])) / 6.0
        liquid = float((cone[:, None] * p.sum(axis=1) / 4.0).sum(axis=0) @ slope)
        weight = float(model.mass @ (position @ load.body_force))
        return stretch_energy(model, position) - liquid - datum * float(cone.sum()) - weight

    force = model.bending_force(x)
    for node in np.flatnonzero(model.free):
        for d in range(3):
            step = np.zeros_like(x)
            step[node, d] = h
            force[node, d] -= (energy(x + step) - energy(x - step)) / (2.0 * h)
    expected = float(np.linalg.norm(force[model.free])) / (WATER * GRAVITY * model.size**3)
    found = residual(model, load, x, datum, np.zeros_like(x))
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("fill", [0.02, 0.3, 0.5, 0.8, 0.98])
def test_the_level_shape_holds_the_volume_and_pulls_nowhere(fill):
    cloth, load = tank(rings=12, fill=fill)
    x = level_shape(cloth.model, load.volume)
    assert cloth.model.volume(x) == pytest.approx(load.volume, rel=1e-9)
    np.testing.assert_array_equal(x[cloth.fixed], cloth.reference[cloth.fixed])
    stretch = np.einsum("tid,tie->tde", x[cloth.triangles], cloth.model.gradients)
    # Chords across the level's edge, up to which no moulded ring need reach, are longer than arcs.
    edge = 0.5 * math.pi / 12
    assert np.linalg.norm(stretch, ord=2, axis=(1, 2)).max() <= 1.0 + edge


def test_more_liquid_than_the_triangles_hold_is_refused():
    cloth, load = tank(fill=0.9999)
    with pytest.raises(ArithmeticError, match="finer grid"):
        settle(cloth, load)


@pytest.mark.parametrize(
    "scene",
    [
        {"fill": 0.02},
        {"fill": 0.98},
        {"rings": 7},
        {"tilt": 60.0, "fill": 0.3},
        {"tilt": 90.0, "fill": 0.8},
        {"tilt": 180.0, "fill": 0.8},
        {"thickness": 0.5e-3, "radius": 0.2032, "fill": 0.3},
        {"radius": 0.6, "gravity": 2.0 * GRAVITY, "thickness": 1e-3},
        {"radius": 0.12, "gravity": 0.01 * GRAVITY, "thickness": 3e-3, "fill": 0.3},
        {"radius": 0.12, "thickness": 3e-3, "fill": 0.3, "resolved": True},
    ],
)
def test_sheets_come_to_rest_and_stay(scene):
    """Ten steps, each solved to 1e-5 R, move the sheet by no more than they may err."""
    cloth, load = tank(**scene)
    done = settle(cloth, load)
    assert done.converged
    assert done.residual <= 1e-6
    assert largest_motion(cloth, load) <= 10 * 1e-5


@pytest.mark.parametrize(("tilt", "modulus"), [(1.17, 8.6e6), (1.17, 8.6e5), (30.0, 8.6e6)])
def test_the_centre_of_gravity_turns_with_gravity(tilt, modulus):
    """A level liquid's centre lies below the tank's, as long as the sheet's length lets it.

    Along the tilt's meridian the level takes t R of the sheet up and as much down along the shell
    and 2 R across, of pi R: up to t = 0.57, 33 degrees. The rim holds back the liquid beside it: a
    plate on a liquid, pinned at its edge, is off the level by exp(-a) cos(a) of it, a = s/(2^(1/2)
    l) from the edge with l^4 = kappa/(rho g), which takes 4 l/(2^(1/2) R) of the moment. 1.17
    degrees are a sway's 0.2 m/s^2.
    """
    cloth, load = tank(tilt=tilt, rings=10, modulus=modulus)
    assert settle(cloth, load).converged
    radius = float(cloth.model.shell.size)
    kappa = modulus * 1.778e-3**3 / 9.0
    held = 4.0 * (kappa / (WATER * GRAVITY)) ** 0.25 / (math.sqrt(2.0) * radius)
    level = 0.375 * radius * math.sin(math.radians(tilt))
    assert 0.0 < 1.0 - centre(cloth)[0] / level < held


def test_a_clamped_sheet_keeps_the_liquid_of_a_tank_on_its_side_back():
    """At 90 degrees the level would take more of the sheet's length than there is: it is taut."""
    slack, load = tank(tilt=30.0)
    assert settle(slack, load).converged
    taut, load = tank(tilt=90.0)
    assert settle(taut, load).converged
    assert centre(slack)[0] < centre(taut)[0] < 0.9 * 0.375 * float(taut.model.shell.size)
    assert np.median(taut.state.tension) > 10.0 * np.median(slack.state.tension)


def test_a_half_full_sheet_stands_level_at_its_rim():
    """It stood up to 35 mm off where it resisted compression enough to buckle."""
    cloth, load = tank(rings=12)
    assert settle(cloth, load).converged
    x = cloth.state.position
    assert np.abs(x[:, 2]).max() <= 0.01 * cloth.model.size


def test_what_is_not_at_rest_says_so():
    cloth, load = tank(fill=0.8)
    done = settle(cloth, load, tolerance=1e-30, steps_max=3)
    assert not done.converged
    assert done.steps == 3
