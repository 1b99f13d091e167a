"""Steps taken again as two halves, where they fail or err too much."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from coupling.ports import Array, HydrostaticLoad, StepFailed, TimeStep

Load = Callable[[float, float], HydrostaticLoad]
_log = logging.getLogger(__name__)
# Of the tolerance, the error below which steps of twice the length will do: theirs is 8 times it.
_SMALL = 1.0 / 8.0
# Of an attempt whose load was not what it should have been; each squares what was wrong.
REPEATED = 6


@dataclass(frozen=True, kw_only=True)
class HalvingSettings:
    """``halvings``: of a step that fails or errs, at most; 0 for none.

    Three go down to an eighth of the step. The effect is in ``tests/benchmarks/README.md``.
    """

    halvings: int = 3


@dataclass(frozen=True, kw_only=True)
class ErrorControl:
    """``error()`` [m] that the last attempt's length adds should be at most ``tolerance`` [m]."""

    error: Callable[[], float]
    tolerance: float


class Halving:
    """Advances a step in halves where the whole does not do; see ``TimeStep.halvable``.

    It does not where it fails, and under ``control`` where its length adds too much of an error.
    The parts of the next step begin as short as the last one's ended, or twice as long where that
    erred by less than an eighth of the tolerance: the method is of second order.
    """

    def __init__(
        self,
        settings: HalvingSettings | None = None,
        *,
        control: ErrorControl | None = None,
        again: Callable[[], HydrostaticLoad | None] = lambda: None,
    ) -> None:
        """``again()``: the load under which to repeat the last attempt, None where it will do."""
        self.settings, self.control, self.again = settings or HalvingSettings(), control, again
        self._depth = 0  # halvings that the next part begins with
        self._error = 0.0  # of the last attempt [m]

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
        return self._part(step, now, dt, load, taken, 0)

    def _part(
        self,
        step: TimeStep,
        now: float,
        dt: float,
        load: Load,
        taken: Callable[[float], None],
        depth: int,
    ) -> int:
        """As ``advance``, of a part that has been halved ``depth`` times."""
        last = depth >= self.settings.halvings or not step.halvable
        if (last or depth >= self._depth) and self._attempt(step, now, dt, load, last=last):
            step.accept()
            taken(dt)
            if self.control is not None:
                small = self._error <= _SMALL * self.control.tolerance
                self._depth = max(depth - small, 0)
            return 1
        half = 0.5 * dt
        first = self._part(step, now, half, load, taken, depth + 1)
        return first + self._part(step, now + half, half, load, taken, depth + 1)

    def _attempt(self, step: TimeStep, now: float, dt: float, load: Load, *, last: bool) -> bool:
        """Whether the part will do."""
        try:
            good = step.attempt(now, dt, load(now, now + dt))
            for _ in range(REPEATED):
                # What is halved all the same needs no other load.
                if not (good or last) or (repeated := self.again()) is None:
                    break
                good = step.attempt(now, dt, repeated)
            else:
                raise ArithmeticError(
                    f"tank: its attitude is not found in {REPEATED} repetitions of the step."
                )
        except (ArithmeticError, StepFailed) as failure:
            if last:
                raise
            _log.info("t = %.6g s: a step of %.3g s is taken as two: %s", now + dt, dt, failure)
            return False
        if self.control is None:
            return last or good
        self._error = self.control.error()
        return last or (good and self._error <= self.control.tolerance)

    def save(self) -> dict[str, Array]:
        """How short the next step's parts begin."""
        return {"depth": np.array([float(self._depth)])}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._depth = int(saved["depth"][0])
