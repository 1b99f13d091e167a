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
        """What ``ask`` says of ``goal`` (n, 3) [m], or half the way there from ``start``, and on.

        Raises the ``StepFailed`` or ArithmeticError that ``ask`` fails with at the last.
        """
        for _ in range(self.settings.halvings):
            try:
                return ask(goal)
            except (StepFailed, ArithmeticError) as failure:
                _log.info("half the way is tried: %s", failure)
                goal = 0.5 * (start + goal)
        return ask(goal)
