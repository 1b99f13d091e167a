"""Coulomb's friction: on a wall so wide that it is an incline, and of a sheet on another, a patch
sticks or slides as it should."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from cloth.flat import disc
from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import Mesh
from cloth.shell.sphere import Sphere
from cloth.step import Cloth

WALL, SIDE, GRAVITY, STEP, FRICTION = 1e4, 0.1, 9.81, 0.01, 0.3
SHEET = diaphragm("AF-E-332", 1.778e-3)
ROUNDING = 1e-15 * WALL


@dataclass(frozen=True)
class Pull:
    body_force: np.ndarray
    density: float = 0.0
    volume: float | None = None
    datum: float | None = 0.0
    turn: None = None
    recoil: None = None


def patch(friction: float) -> Cloth:
    """A free disc on the lowest point of the wall."""
    flat = disc(SIDE, 3, 8)
    points = flat.points.copy()
    points[:, 2] = -np.sqrt(WALL**2 - np.sum(points[:, :2] ** 2, axis=1))
    mesh = Mesh(
        points=points, triangles=flat.triangles, fixed=np.zeros(len(points), dtype=bool),
        rim_distance=flat.rim_distance,
    )  # fmt: skip
    settings = Settings(tolerance=1e-9, shell_friction=friction, bending_damping=0.0, drag=0.0)
    return Cloth(
        mesh=mesh, diaphragm=SHEET, shell=Sphere(WALL),
        compressive_stiffness=0.0, settings=settings,
    )  # fmt: skip


def pulled(slope: float) -> Pull:
    """Gravity over an incline of the angle ``slope``."""
    return Pull(body_force=GRAVITY * np.array([np.sin(slope), 0.0, -np.cos(slope)]))


def advance(cloth: Cloth, load: Pull, steps: int) -> tuple[float, float]:
    """Way of the centre of mass along x [m], and what friction on the shell took [J]."""
    start, lost = cloth.state.position, 0.0
    for _ in range(steps):
        cloth.begin_step(STEP, load)
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
        assert cloth.losses().shell_friction >= -ROUNDING * GRAVITY * cloth.mass.sum() / STEP
        lost += STEP * cloth.losses().shell_friction
    way = float(cloth.mass @ (cloth.state.position - start)[:, 0] / cloth.mass.sum())
    return way, lost


@pytest.mark.parametrize("friction", [0.1, 0.3, 1.2])
def test_sticks_below_the_angle_of_friction(friction: float):
    """Not by a slow creep: no node moves, to the rounding of the wall's radius."""
    cloth = patch(friction)
    way, lost = advance(cloth, pulled(0.98 * np.arctan(friction)), 20)
    assert abs(way) < 20 * ROUNDING
    assert lost < 20 * ROUNDING * GRAVITY * cloth.mass.sum()


@pytest.mark.parametrize("friction", [0.0, 0.1, 0.3, 1.2])
def test_slides_above_it_at_its_acceleration(friction: float):
    """g (sin - mu cos); friction takes mu N times the way. The wall is bent by SIDE/WALL, 1e-5."""
    slope, steps = np.arctan(friction) + 0.2, 20
    cloth = patch(friction)
    way, lost = advance(cloth, pulled(slope), steps)
    speed = float(cloth.mass @ cloth.state.velocity[:, 0] / cloth.mass.sum())
    acceleration = GRAVITY * (np.sin(slope) - friction * np.cos(slope))
    assert speed == pytest.approx(acceleration * steps * STEP, rel=1e-4)
    weight = GRAVITY * np.cos(slope) * cloth.mass.sum()
    assert lost == pytest.approx(friction * weight * way, rel=1e-4)


def test_thrown_patch_comes_to_rest_and_friction_has_taken_its_energy():
    """After v^2/(2 mu g), to the step in which it stops: dt/(v/(mu g)) of the way."""
    cloth, speed = patch(FRICTION), 0.5
    throw = np.zeros_like(cloth.reference)
    throw[:, 0] = speed
    cloth.restore({**cloth.save(), "velocity": throw})
    way, lost = advance(cloth, pulled(0.0), 40)
    allowed = 2.0 * STEP / (speed / (FRICTION * GRAVITY))
    assert way == pytest.approx(speed**2 / (2.0 * FRICTION * GRAVITY), rel=allowed)
    assert lost == pytest.approx(0.5 * cloth.mass.sum() * speed**2, rel=allowed)
    still, more = advance(cloth, pulled(0.0), 5)
    assert abs(still) < 10 * ROUNDING
    assert more < 10 * ROUNDING * GRAVITY * cloth.mass.sum()


def stacked(friction: float) -> Cloth:
    """A free disc, the first nodes, that lies on a fixed one, a thickness above it."""
    upper, lower = disc(SIDE, 2, 6), disc(3.0 * SIDE, 2, 7)
    count = len(upper.points)
    above = upper.points + np.array([0.013, 0.007, SHEET.thickness])
    points = np.concatenate([above, lower.points])
    mesh = Mesh(
        points=points,
        triangles=np.concatenate([upper.triangles, lower.triangles + count]),
        fixed=np.arange(len(points)) >= count,
        rim_distance=np.ones(len(points)),
    )
    settings = Settings(tolerance=1e-7, self_friction=friction, bending_damping=0.0, drag=0.0)
    return Cloth(
        mesh=mesh, diaphragm=SHEET, shell=Sphere(100.0 * SIDE), self_contact=True, settings=settings
    )  # fmt: skip


def ride(slope: float, friction: float, steps: int) -> tuple[float, float, float, float]:
    """Way [m] and speed [m/s] of the upper disc along x, what friction took [J], its mass [kg]."""
    cloth = stacked(friction)
    mass = np.where(cloth.fixed, 0.0, cloth.mass)
    start, lost = cloth.state.position, 0.0
    for _ in range(steps):
        cloth.begin_step(STEP, pulled(slope))
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
        lost += STEP * cloth.losses().self_friction
    state, whole = cloth.state, float(mass.sum())
    way = float(mass @ (state.position - start)[:, 0]) / whole
    return way, float(mass @ state.velocity[:, 0]) / whole, lost, whole


def test_a_sheet_sticks_on_another_below_the_angle_of_friction():
    """But for what the inner iteration leaves in each step, its tolerance times the size, rms: at a
    single node of some 30 it may be sqrt(30) times that. Without friction it would slide by some
    10 mm."""
    steps = 10
    way, _, lost, mass = ride(0.8 * np.arctan(FRICTION), FRICTION, steps)
    left = steps * 1e-7 * 3.0 * SIDE
    assert abs(way) < left
    assert abs(lost) < np.sqrt(30.0) * left * GRAVITY * mass


def test_a_sheet_slides_on_another_at_its_acceleration():
    """What comes to touch after a step's one look, as edges pass over edges, rubs from the next
    step on: 0.5 % is found, a fifth of the push of one step of the ten allowed."""
    slope, steps = np.arctan(FRICTION) + 0.2, 10
    way, speed, lost, mass = ride(slope, FRICTION, steps)
    acceleration = GRAVITY * (np.sin(slope) - FRICTION * np.cos(slope))
    assert speed == pytest.approx(acceleration * steps * STEP, rel=0.02)
    assert lost == pytest.approx(FRICTION * mass * GRAVITY * np.cos(slope) * way, rel=0.02)
