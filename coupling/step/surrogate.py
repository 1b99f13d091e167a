"""The next iterate where the liquid's inertia changes much within a step."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from enum import Enum, auto

from coupling.ports import Array, StepFailed
from coupling.schemes.iqn_ils import IqnIls
from coupling.step.convergence import rms
from coupling.step.interface_problem import InterfaceProblem
from coupling.step.interface_step import Iterate

_log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class SurrogateSettings:
    """Constants of the surrogate, found by trial on violent sways.

    - ``rate``: share of the residual that an iteration with the liquid's inertia should leave; the
      surrogate takes over where two in a row leave more, and is given up once it does no better,
      or where its own solve leaves more;
    - ``left``: share of the residual that solve goes down to: what the surrogate lacks leaves more;
    - ``iterations``: of the solve, at most; 0 for none at all.

    Figures are in ``tests/benchmarks/README.md``: in a violent sway of 540 cells the surrogate
    saves 0.3 per cent of the iterations, and none of the steps that fail.
    """

    rate: float = 0.3
    left: float = 0.03
    iterations: int = 8


class _Use(Enum):
    """What the surrogate does on a map."""

    WAITS = auto()
    LEADS = auto()
    GIVEN_UP = auto()


class Surrogate:
    """Takes over from the scheme where iterations are slow.

    The liquid's inertia, held during the step, changes with the shape: the next iterate is sought
    with its change as a surrogate of the flow's.
    """

    def __init__(self, settings: SurrogateSettings) -> None:
        self.settings = settings
        self._use = _Use.GIVEN_UP

    def begin_map(self) -> None:
        """Forget what has been learnt of the surrogate on another map."""
        self._use = _Use.WAITS if self.settings.iterations else _Use.GIVEN_UP

    def next(
        self,
        problem: InterfaceProblem,
        iterate: Iterate,
        guess: Array,
        on_map: list[float],
        *,
        tolerance: float,
    ) -> Array | None:
        """The iterate (p, 3) [m] after ``iterate``, None where the scheme's own should be taken.

        ``guess`` (p, 3) [m]: the scheme's; ``on_map``: relative residuals on this map;
        ``tolerance``: that of the step.
        """
        rate = self.settings.rate
        if self._use is _Use.LEADS and not on_map[-1] <= rate * on_map[-2]:
            self._use = _Use.GIVEN_UP
        slow = len(on_map) > 2 and on_map[-1] > rate**2 * on_map[-3]
        if self._use is _Use.GIVEN_UP or (self._use is _Use.WAITS and not slow):
            return None
        found: Array | None = None
        try:
            found = surrogate_iterate(
                problem, iterate, guess, tolerance=rate * tolerance / on_map[-1],
                settings=self.settings,
            )  # fmt: skip
        except (StepFailed, ArithmeticError) as failure:
            _log.info("the surrogate is given up: %s", failure)
        self._use = _Use.GIVEN_UP if found is None else _Use.LEADS
        return found


def surrogate_iterate(
    problem: InterfaceProblem,
    iterate: Iterate,
    guess: Array,
    *,
    tolerance: float,
    settings: SurrogateSettings,
) -> Array | None:
    """The interface y (p, 3) [m] that solves the ``problem`` with its surrogate at ``iterate``.

    Defect correction (Stetter, Numer. Math. 29, 1978): at the ``iterate``'s x the surrogate leads
    to the very image that the flow has led to; from there to y its pressure changes as the liquid's
    inertia does. What it lacks of the change is left to the next iteration. It is solved from
    ``guess`` (p, 3) [m], by quasi-Newton steps of its own, to ``tolerance`` or ``settings.left`` of
    the residual at x. None where it is not; raises ``StepFailed``, ArithmeticError.
    """
    answer, scheme = problem.surrogate(iterate), IqnIls(1.0, 0)
    scheme.update(iterate.points.ravel(), iterate.residual.ravel())
    start = rms(iterate.residual)
    for _ in range(settings.iterations):
        points = problem.close_volume(guess)
        residual = answer(points) - points
        guess = scheme.update(points.ravel(), residual.ravel()).reshape(points.shape)
        left = rms(residual) / start
        if left <= max(tolerance, settings.left):
            return guess
    return guess if left <= settings.rate else None
