"""A sheet in axes that turn moves as in axes that do not, and its damping sees no rigid turn."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import hemisphere
from cloth.step import Cloth

RUBBER = diaphragm("AF-E-332", 1.778e-3)
R = 0.2
AXIS = np.array([0.3, -0.5, 0.8])
GRAVITY = np.array([0.0, 0.0, -9.81])
STEP = 0.01


@dataclass(frozen=True)
class Turn:
    last: np.ndarray
    before: np.ndarray


@dataclass(frozen=True)
class Pull:
    """A body force alone: no liquid."""

    body_force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    density: float = 0.0
    volume: float | None = None
    datum: float | None = 0.0
    turn: Turn | None = None
    recoil: None = None


def free(rings: int, settings: Settings, **options) -> Cloth:
    mesh = hemisphere(R, rings)
    loose = replace(mesh, fixed=np.zeros(len(mesh.points), dtype=bool))
    return Cloth(mesh=loose, diaphragm=RUBBER, settings=settings, **options)


def attitude(time: float) -> np.ndarray:
    """Of axes that turn ever faster, from rest."""
    return Rotation.from_rotvec(20.0 * time**2 * AXIS).as_matrix()


def moved(cloth: Cloth, steps: int, *, turns: bool) -> np.ndarray:
    """Where the sheet comes to, in axes that do not turn (n, 3) [m]."""
    here = [np.eye(3)] * 3
    for number in range(1, steps + 1):
        if turns:
            here = [attitude(max(number - k, 0) * STEP) for k in range(3)]
        turn = Turn(here[0].T @ here[1], here[0].T @ here[2]) if turns else None
        cloth.begin_step(STEP, Pull(body_force=GRAVITY @ here[0], turn=turn))
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
    return cloth.state.position @ here[0].T


def test_inertia_is_that_of_axes_that_do_not_turn():
    """A dome thrown and stretched in free fall, undamped: the same way, to the tolerance.

    The axes have turned by half a radian. 1e-9 of the size is left in a step; 8 steps of second
    order carry that on by a factor of some tens.
    """
    settings = Settings(tolerance=1e-9, iterations=4000, bending_damping=0.0, drag=0.0)
    ways = []
    for turns in (False, True):
        cloth = free(3, settings)
        start = cloth.save()
        start["velocity"] = np.cross([2.0, 1.0, 0.5], cloth.reference) + 0.3 * cloth.reference
        cloth.restore(start)
        ways.append(moved(cloth, 8, turns=turns))
    assert np.abs(ways[0] - cloth.reference).max() > 0.1 * R
    np.testing.assert_allclose(ways[1], ways[0], atol=1e-7 * R)


@pytest.mark.parametrize("settings", [Settings(drag=100.0), Settings(bending_damping=50.0)])
def test_damping_sees_no_rigid_turn(settings: Settings):
    """A dome that spins with its axes about z keeps its spin, to the steps' own (omega dt)^2.

    Drag that saw it would halve its speed within a step. What the dome loses is that of the
    little by which it opens as it spins.
    """
    rate, cloth = 3.0, free(3, settings)
    start = cloth.save()
    start["velocity"] = np.cross([0.0, 0.0, rate], cloth.reference)
    cloth.restore(start)
    turned = [Rotation.from_rotvec([0.0, 0.0, -rate * STEP * k]).as_matrix() for k in (1, 2)]
    for _ in range(6):
        cloth.begin_step(STEP, Pull(turn=Turn(*turned)))
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
    spin = cloth.mass @ np.cross(cloth.state.position, cloth.state.velocity)
    first = rate * float(cloth.mass @ np.sum(cloth.reference[:, :2] ** 2, axis=1))
    assert spin[2] == pytest.approx(first, rel=2.0 * (rate * STEP) ** 2)
    losses = cloth.losses()
    assert (losses.drag + losses.bending) * STEP < 1e-3 * cloth.energy().kinetic


def test_a_held_sheet_moves_with_the_shell():
    """Its nodes stay in the tank; their velocity is omega x r to the steps' (omega dt)^2."""
    cloth = Cloth(mesh=hemisphere(R, 3), diaphragm=RUBBER, held=True)
    rate, before = 2.0, cloth.state.position
    turned = [Rotation.from_rotvec(-rate * STEP * k * np.eye(3)[1]).as_matrix() for k in (1, 2)]
    for _ in range(4):
        cloth.begin_step(STEP, Pull(turn=Turn(*turned)))
        cloth.solve(np.zeros_like(before))
        cloth.accept_step()
    np.testing.assert_array_equal(cloth.state.position, before)
    wanted = np.cross([0.0, rate, 0.0], before)
    np.testing.assert_allclose(cloth.state.velocity, wanted, atol=(rate * STEP) ** 2 * rate * R)


def test_the_liquid_that_a_turning_rim_moves_pushes_the_sheet():
    """Liquid inertia of a rim and a node: the node is pushed by what the rim's motion takes.

    B^T B (x - x~)/b^2 of all nodes, those that are held as well.
    """
    cloth = Cloth(mesh=hemisphere(R, 3), diaphragm=RUBBER, settings=Settings(drag=0.0))
    row = np.random.default_rng(2).normal(size=(1, *cloth.reference.shape))
    angle = 0.02
    last = Rotation.from_rotvec(-angle * np.eye(3)[2]).as_matrix()
    cloth.begin_step(STEP, Pull(turn=Turn(last, last)), row)
    with_rim = cloth._problem.constant_force
    cloth.begin_step(
        STEP, Pull(turn=Turn(last, last)), np.where(cloth.fixed[None, :, None], 0.0, row)
    )
    without = cloth._problem.constant_force
    moved = np.where(cloth.fixed[:, None], cloth.reference - cloth.reference @ last.T, 0.0)
    wanted = -float(np.vdot(row[0], moved)) / STEP**2 * row[0]
    free_nodes = ~cloth.fixed
    np.testing.assert_allclose(
        (with_rim - without)[free_nodes], wanted[free_nodes], rtol=1e-9, atol=1e-9
    )
