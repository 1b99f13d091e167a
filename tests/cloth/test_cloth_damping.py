"""Bending damping acts on bending alone, and at the rate of its theory."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pytest
import scipy.linalg as sl

from cloth.kinematics import kinematics
from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import Mesh, border_nodes, hemisphere
from cloth.shell.sphere import Sphere
from cloth.step import Cloth

SHEET = diaphragm("AF-E-332", 1.778e-3)


@dataclass(frozen=True)
class Nothing:
    density: float = 0.0
    body_force: np.ndarray = field(default_factory=lambda: np.zeros(3))
    volume: float | None = None
    datum: float | None = 0.0
    turn: None = None
    recoil: None = None


def free(mesh: Mesh, settings: Settings) -> Cloth:
    """Neither clamped nor near a shell."""
    loose = replace(mesh, fixed=np.zeros(len(mesh.points), dtype=bool))
    return Cloth(
        mesh=loose,
        diaphragm=SHEET,
        shell=Sphere(10.0),
        compressive_stiffness=0.0,
        settings=settings,
    )


def advance(cloth: Cloth, velocity: np.ndarray, dt: float, steps: int) -> np.ndarray:
    cloth.restore({**cloth.save(), "velocity": velocity})
    for _ in range(steps):
        cloth.begin_step(dt, Nothing())
        cloth.solve(np.zeros_like(velocity))
        cloth.accept_step()
    return cloth.state.velocity


def plate(side: float, cells: int) -> Mesh:
    """A flat square in x and y, held along its border."""
    x, y = np.meshgrid(*2 * [np.linspace(0.0, side, cells + 1)])
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(x.size)])
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    a, b, c, d = corner, corner + 1, corner + cells + 2, corner + cells + 1
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    border = np.zeros(len(points), dtype=bool)
    border[border_nodes(triangles)] = True
    return Mesh(points=points, triangles=triangles, fixed=border, rim_distance=np.ones(len(points)))


@pytest.mark.parametrize("tau", [0.05, 3.0])
def test_rigid_motion_of_the_moulded_shape_is_not_damped(tau):
    """Turning by 1e-5 rad: the second order in it, 1e-10 of stretch, is all that may be felt."""
    cloth = free(hemisphere(0.4445, 6), Settings(bending_damping=tau, drag=0.0))
    turning = np.cross([1e-3, 5e-4, 0.0], cloth.reference) + np.array([0.0, 3e-4, -2e-4])
    end = advance(cloth, turning, 1e-3, 10)
    np.testing.assert_allclose(end, turning, atol=1e-4 * np.abs(turning).max())


@pytest.mark.parametrize("tau", [0.05, 0.5])
def test_bending_wave_decays_at_its_rate(tau):
    """q'' + tau w^2 q' + w^2 q = 0: the velocity of a mode after a time, second order in dt.

    w^2 is the mode's own, a simply supported plate's kappa (2 (pi/side)^2)^2 / (rho_d t) but for
    the grid's (pi/cells)^2/6, twice.
    """
    side, cells = 0.3, 12
    mesh = plate(side, cells)
    cloth = Cloth(
        mesh=mesh,
        diaphragm=SHEET,
        compressive_stiffness=0.0,
        settings=Settings(bending_damping=tau, drag=0.0, penalty=1e-2),
    )
    sine = np.prod(np.sin(np.pi * cloth.reference[:, :2] / side), axis=1)
    inside = ~mesh.fixed
    matrix = cloth.model.bending.matrix.toarray()[np.ix_(inside, inside)]
    values, modes = sl.eigh(matrix, np.diag(cloth.mass[inside]))
    best = int(np.argmax(np.abs(modes.T @ (sine * cloth.mass)[inside])))
    square, mode = values[best], np.zeros(len(sine))
    mode[inside] = modes[:, best]
    exact = SHEET.bending_stiffness * (2.0 * (np.pi / side) ** 2) ** 2 / SHEET.area_density
    assert square == pytest.approx(exact, rel=2.0 * (np.pi / cells) ** 2 / 6.0)
    root = np.sqrt(complex((0.5 * tau * square) ** 2 - square))
    fast, slow = -0.5 * tau * square - root, -0.5 * tau * square + root
    dt, steps = 0.02 / (tau * square), 50
    t = dt * steps
    wanted = ((fast * np.exp(fast * t) - slow * np.exp(slow * t)) / (fast - slow)).real
    velocity = np.zeros_like(cloth.reference)
    velocity[:, 2] = 1e-6 * mode
    end = advance(cloth, velocity, dt, steps)[:, 2]
    got = float(mode @ (cloth.mass * end)) / 1e-6
    late = square * dt**2 / 3.0 * np.sqrt(square) * t  # BDF2's phase error
    assert got == pytest.approx(wanted, rel=1e-3, abs=late)


@pytest.mark.parametrize("steps", [(1e-3,), (1e-3, 1e-3), (1e-3, 1e-3, 5e-4), (5e-4, 1e-3)])
def test_bending_loss_is_that_of_the_step_s_own_formula(steps):
    """An Euler step, an even one, and one of half or twice the length of the one before."""
    tau = 0.05
    cloth = free(hemisphere(0.4445, 6), Settings(bending_damping=tau, drag=0.0))
    velocity = cloth.reference * [0.1, -0.1, 0.0]
    cloth.restore({**cloth.save(), "velocity": velocity})
    before = cloth.reference
    for dt in steps:
        start, saved = cloth.state.position, cloth.save()
        kin = kinematics(
            dt, float(saved["previous_dt"][0]), start, saved["velocity"],
            saved["previous_position"], saved["previous_velocity"],
        )  # fmt: skip
        cloth.begin_step(dt, Nothing())
        cloth.solve(np.zeros_like(velocity))
        cloth.accept_step()
        before = start
    end = cloth.state.position
    force = cloth.model.held_normals_force
    moment = tau / kin.b * (force(end) - force(kin.position_anchor))
    expected = -float(np.vdot((end - before) / steps[-1], moment))
    assert cloth.losses().bending == pytest.approx(expected, rel=1e-9)
    assert expected > 0.0
