"""The history of a sheet whose shell turns, in the axes in which a step is solved.

Positions are kept in the shell's own axes, velocities in axes that do not turn and are the shell's
at their instant. A step ends in the shell's axes of its end. There the mass times acceleration of
axes that do not turn is the same formula of the history turned into them, x -> Q x (``inertial``),
whatever the turn: neither Coriolis' nor Euler's force appears. What resists the sheet's motion
relative to the shell, such as damping, takes the positions as they are kept (``relative``): a
rigid turn is no motion there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cloth.arrays import Array, Bools
from cloth.kinematics import Kinematics, kinematics
from cloth.load import Turn
from cloth.model import ClothModel
from cloth.state import Memory


def inertial(memory: Memory, dt: float, turn: Turn | None) -> Kinematics:
    """Return the kinematics, in axes that do not turn, of a step of ``dt`` [s] from ``memory``."""
    m, previous = memory, float(memory.previous_dt[0])
    if turn is None:
        return relative(memory, dt)
    last, before = turn.last.T, turn.before.T
    return kinematics(
        dt, previous, m.position @ last, m.velocity @ last,
        m.previous_position @ before, m.previous_velocity @ before,
    )  # fmt: skip


def relative(memory: Memory, dt: float) -> Kinematics:
    """Return the same of the positions in the shell's own axes."""
    m = memory
    return kinematics(
        dt, float(m.previous_dt[0]), m.position, m.velocity,
        m.previous_position, m.previous_velocity,
    )  # fmt: skip


def expected(memory: Memory, dt: float, turn: Turn | None, clamped: Array, free: Bools) -> Array:
    """Return where a step's iteration sets out: where the sheet comes to without acceleration.

    Parameters
    ----------
    memory, dt, turn
        The sheet, the step's length [s], and how its shell turns.
    clamped, free
        Where fixed nodes are held in the shell (n, 3) [m], and which nodes are not fixed (n,).

    Returns
    -------
    Array
        Positions (n, 3) [m].
    """
    ahead = memory.position + dt * memory.velocity
    if turn is None:
        return ahead
    return np.where(free[:, None], ahead @ turn.last.T, clamped)


def carried(memory: Memory, kin: Kinematics, dt: float) -> Memory:
    """Return the memory of a sheet that is held in a turning shell, after a step of ``dt`` [s]."""
    m = memory
    return replace(
        m, velocity=kin.velocity(m.position), previous_position=m.position,
        previous_velocity=m.velocity, previous_dt=np.array([dt]),
    )  # fmt: skip


def rim_inertia(liquid_inertia: Array, model: ClothModel, kin: Kinematics) -> Array:
    """Return what the liquid that a turning rim accelerates adds to the inertia of a step.

    Parameters
    ----------
    liquid_inertia
        Rows B (r, n, 3) [kg^(1/2)].
    model
        The sheet: its fixed nodes, and where they are held.
    kin
        Kinematics of the step, in axes that do not turn.

    Returns
    -------
    Array
        B/b (x - x~) of the fixed nodes (r,) [sqrt(N m)].
    """
    moved = np.where(model.free[:, None], 0.0, model.clamped - kin.prediction)
    flat = liquid_inertia.reshape(len(liquid_inertia), -1)
    return np.asarray(flat @ moved.ravel() / kin.b)
