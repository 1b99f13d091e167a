"""The step of a diaphragm without a flow, and steps taken again as two halves where they fail."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Protocol

import numpy as np

from coupling.ports import HydrostaticLoad, StepFailed
from coupling.structure.diaphragm import Diaphragm

HALVINGS = 3

_log = logging.getLogger(__name__)


class Step(Protocol):
    """A time step that can be tried with a shorter ``dt`` if it fails."""

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]; whether it is good enough.

        Raises ArithmeticError or ``StepFailed``.
        """

    def accept(self) -> None:
        """Commit the last attempt."""


class DryStep:
    """The step of a diaphragm under a hydrostatic load alone."""

    def __init__(self, cloth: Diaphragm) -> None:
        self.cloth = cloth

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """See ``Step``."""
        self.cloth.begin_step(dt, load)
        self.cloth.solve(np.zeros_like(self.cloth.reference))
        return self.cloth.converged

    def accept(self) -> None:
        """See ``Step``."""
        self.cloth.accept_step()


def advance(
    step: Step,
    now: float,
    dt: float,
    load: Callable[[float, float], HydrostaticLoad],
    *,
    halvings: int = HALVINGS,
    taken: Callable[[float], None] = lambda _: None,
) -> int:
    """Take ``step`` from ``now`` to ``now + dt`` [s] under ``load(start, end)``; parts it took.

    A step that does not converge is taken again as two of half its length, ``halvings`` times at
    most; the last is accepted as it is, unless it fails. Raises its ArithmeticError or
    ``StepFailed`` then. ``taken`` is told the length [s] of every part, once accepted.
    """
    try:
        good = step.attempt(now, dt, load(now, now + dt)) or halvings == 0
    except (ArithmeticError, StepFailed) as failure:
        if halvings == 0:
            raise
        _log.info("t = %.6g s: a step of %.3g s is taken as two: %s", now + dt, dt, failure)
        good = False
    if good:
        step.accept()
        taken(dt)
        return 1
    half = 0.5 * dt
    first = advance(step, now, half, load, halvings=halvings - 1, taken=taken)
    return first + advance(step, now + half, half, load, halvings=halvings - 1, taken=taken)
