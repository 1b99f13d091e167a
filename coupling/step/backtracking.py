"""Backtracking: where a goal has no answer, half the way to it is tried."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

from coupling.ports import Array, StepFailed

_log = logging.getLogger(__name__)
Answer = TypeVar("Answer")


@dataclass(frozen=True, kw_only=True)
class BacktrackingSettings:
    """``halvings``: of the way to the goal, at most; 0 takes the goal or fails.

    Four go back to a sixteenth of the way. Neither scene of ``tests/benchmarks/README.md`` goes
    back at all: it is for iterates without a valid mesh, which end a step otherwise.
    """

    halvings: int = 4


class Backtracking:
    """Asks for a goal, or for what lies on the way to it."""

    def __init__(self, settings: BacktrackingSettings) -> None:
        self.settings = settings

    def nearest(self, ask: Callable[[Array], Answer], goal: Array, start: Array) -> Answer:
        """Return the answer for a goal, or for a point on the way to it where the goal has none.

        The way is halved after every failure.

        Parameters
        ----------
        ask
            Gives the answer for positions (n, 3) [m].
        goal
            Positions asked for (n, 3) [m].
        start
            Positions from which the way leads to them (n, 3) [m].

        Returns
        -------
        Answer
            What ``ask`` returns for the first point at which it does not fail.

        Raises
        ------
        StepFailed, ArithmeticError
            What ``ask`` fails with at the last.
        """
        for _ in range(self.settings.halvings):
            try:
                return ask(goal)
            except (StepFailed, ArithmeticError) as failure:
                _log.info("half the way is tried: %s", failure)
                goal = 0.5 * (start + goal)
        return ask(goal)
