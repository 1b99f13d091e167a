"""Steps taken again as two halves where they fail."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass

from coupling.ports import HydrostaticLoad, StepFailed, TimeStep

Load = Callable[[float, float], HydrostaticLoad]
_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class HalvingSettings:
    """``halvings``: of a step that fails, at most; 0 ends the run with the first failure.

    Three go down to an eighth of the step. The effect is in ``tests/benchmarks/README.md``.
    """

    halvings: int = 3


class Halving:
    """Advances a step in halves where the whole does not converge; see ``TimeStep.halvable``."""

    def __init__(self, settings: HalvingSettings | None = None) -> None:
        self.settings = settings or HalvingSettings()

    def advance(
        self,
        step: TimeStep,
        now: float,
        dt: float,
        load: Load,
        *,
        taken: Callable[[float], None] = lambda _: None,
    ) -> int:
        """Take ``step`` from ``now`` to ``now + dt`` [s] under ``load(start, end)``; parts it took.

        The last halves are accepted as they are, unless they fail. Raises their ArithmeticError or
        ``StepFailed`` then. ``taken`` is called with the length [s] of every part, once accepted.
        """
        left = self.settings.halvings if step.halvable else 0
        return self._part(step, now, dt, load, taken, left)

    def _part(
        self,
        step: TimeStep,
        now: float,
        dt: float,
        load: Load,
        taken: Callable[[float], None],
        left: int,
    ) -> int:
        """As ``advance``, with ``left`` halvings."""
        try:
            good = step.attempt(now, dt, load(now, now + dt)) or left == 0
        except (ArithmeticError, StepFailed) as failure:
            if left == 0:
                raise
            _log.info("t = %.6g s: a step of %.3g s is taken as two: %s", now + dt, dt, failure)
            good = False
        if good:
            step.accept()
            taken(dt)
            return 1
        half = 0.5 * dt
        first = self._part(step, now, half, load, taken, left - 1)
        return first + self._part(step, now + half, half, load, taken, left - 1)
