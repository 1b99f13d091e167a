"""How hard the diaphragm presses on the shell and on itself, how far it slides there, what that is.

Wear is taken to go with the slip's work per area, int p ds (Archard, J. Appl. Phys. 24 (1953) 981):
p is the normal force of a node over its moulded area, the rubber's that wears, and over a step the
mean of its values at both ends; s is what the node slides along.
"""

from __future__ import annotations

from typing import TypedDict

import numpy as np

from cloth.arrays import Array
from cloth.contact import slid
from cloth.problem import Solution, StepProblem
from cloth.state import Memory


class Rubbed(TypedDict):
    """What ``cloth.state.Memory`` keeps of a step's contacts, by its names there."""

    shell_pressure: Array
    self_pressure: Array
    shell_slip: Array
    self_slip: Array
    shell_work: Array
    self_work: Array
    rub_place: Array


def rubbed(problem: StepProblem, solution: Solution, before: Memory) -> Rubbed:
    """Return pressures after a step, and what has slid up to then.

    A node rubs on the shell in a step where it is within half a thickness of it and presses on it
    at both ends; on another part of the sheet where it touches that at the end.
    """
    p, s, m = problem, solution, before
    shell, reach = p.model.shell, 0.5 * float(p.model.thickness.max())
    force = np.where(shell.gap(s.position) < reach, s.pressing[:, 0], 0.0)
    on_shell, on_self = force / p.model.node_areas, s.pressing[:, 1] / p.model.node_areas
    rubbing = (m.shell_pressure > 0.0) & (on_shell > 0.0)
    way = slid(m.position, s.position, rubbing, shell)
    self_way = np.zeros_like(way) if s.contact is None else s.contact.node_slip()
    work = 0.5 * (m.shell_pressure + on_shell) * way
    total = m.shell_work + work
    share = np.divide(work, total, out=np.zeros_like(work), where=total > 0.0)
    place = shell.project(0.5 * (m.position + s.position)) - m.rub_place
    return Rubbed(
        shell_pressure=on_shell,
        self_pressure=on_self,
        shell_slip=m.shell_slip + way,
        self_slip=m.self_slip + self_way,
        shell_work=total,
        self_work=m.self_work + 0.5 * (m.self_pressure + on_self) * self_way,
        rub_place=m.rub_place + share[:, None] * place,
    )
