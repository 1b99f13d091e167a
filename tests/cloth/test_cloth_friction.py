"""Friction on the shell: a patch on a wall so wide that it is an incline sticks or slides as
Coulomb has it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from cloth.flat import disc
from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import Mesh
from cloth.step import Cloth

WALL, SIDE, GRAVITY, STEP, FRICTION = 1e4, 0.1, 9.81, 0.01, 0.3
ROUNDING = 1e-15 * WALL


@dataclass(frozen=True)
class Pull:
    body_force: np.ndarray
    density: float = 0.0
    volume: float | None = None
    datum: float | None = 0.0


def patch(friction: float) -> Cloth:
    """A free disc on the lowest point of the wall."""
    flat = disc(SIDE, 3, 8)
    points = flat.points.copy()
    points[:, 2] = -np.sqrt(WALL**2 - np.sum(points[:, :2] ** 2, axis=1))
    mesh = Mesh(
        points=points, triangles=flat.triangles, fixed=np.zeros(len(points), dtype=bool),
        rim_distance=flat.rim_distance,
    )  # fmt: skip
    settings = Settings(tolerance=1e-9, friction=friction, bending_damping=0.0, drag=0.0)
    return Cloth(
        mesh=mesh, diaphragm=diaphragm("AF-E-332", 1.778e-3), shell_radius=WALL,
        compressive_stiffness=0.0, settings=settings,
    )  # fmt: skip


def pulled(slope: float) -> Pull:
    """Gravity over an incline of the angle ``slope``."""
    return Pull(body_force=GRAVITY * np.array([np.sin(slope), 0.0, -np.cos(slope)]))


def advance(cloth: Cloth, load: Pull, steps: int) -> tuple[float, float]:
    """Way of the centre of mass along x [m], and what friction took [J]."""
    start, lost = cloth.state.position, 0.0
    for _ in range(steps):
        cloth.begin_step(STEP, load)
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
        assert cloth.losses().friction >= -ROUNDING * GRAVITY * cloth.mass.sum() / STEP
        lost += STEP * cloth.losses().friction
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
