"""Steps taken again as two halves where they fail."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

from coupling.ports import HydrostaticLoad, StepFailed, TimeStep

_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class HalvingSettings:
    """``halvings``: of a step that fails, at most; 0 ends the run with the first failure."""

    halvings: int = 3


def advance(
    step: TimeStep,
    now: float,
    dt: float,
    load: Callable[[float, float], HydrostaticLoad],
    *,
    halvings: int | None = None,
    taken: Callable[[float], None] = lambda _: None,
) -> int:
    """Take ``step`` from ``now`` to ``now + dt`` [s] under ``load(start, end)``; parts it took.

    A step that does not converge is taken again as two of half its length, ``halvings`` times at
    most; the last is accepted as it is, unless it fails. Raises its ArithmeticError or
    ``StepFailed`` then. ``taken`` is called with the length [s] of every part, once accepted.
    """
    halvings = HalvingSettings().halvings if halvings is None else halvings
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
