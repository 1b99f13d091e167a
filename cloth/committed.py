"""What a step leaves behind once its solution is accepted: the next one's start, and its losses."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from cloth.energy import SheetLosses, rubber_at, sheet_losses, stretch_loss
from cloth.problem import Solution, StepProblem
from cloth.rubbing import rubbed
from cloth.state import Memory


def committed(
    problem: StepProblem, solution: Solution, before: Memory
) -> tuple[Memory, SheetLosses]:
    """Return the memory after ``problem``, begun from ``before``, and what was lost in it."""
    p, s, m = problem, solution, before
    rubber, slack = rubber_at(p.model, s.position, p.rest)
    after = Memory(
        position=s.position,
        velocity=p.kin.turned(s.turned).velocity(s.position),
        previous_position=m.position,
        previous_velocity=m.velocity,
        previous_dt=np.array([p.dt]),
        tension=s.tension,
        contact_force=s.contact_force,
        datum=np.array([s.datum]),
        volume=np.array([s.volume]),
        strain=s.strain,
        rubber_strain=rubber,
        change=np.array([s.change]),
        **rubbed(p, s, m),
        near=np.array([float(s.contact is not None and s.contact.near.any())]),
    )
    damping, strained = p.settings.stretch_damping, rubber - m.rubber_strain
    losses = replace(
        sheet_losses(p.model, p.settings, _in_shell(p, after), p.kin.b),
        stretch=stretch_loss(p.model, damping, strained, slack, p.dt),
        shell_friction=float(np.vdot(s.rub, s.position - m.position)) / p.dt,
        self_friction=float(np.vdot(s.self_rub, s.position - m.position)) / p.dt,
    )
    return after, losses


def _in_shell(problem: StepProblem, after: Memory) -> Memory:
    """``after`` with the velocity in the shell's own axes, where that turns."""
    p = problem
    if p.own is p.kin:
        return after
    return replace(after, velocity=p.own.velocity(after.position))
