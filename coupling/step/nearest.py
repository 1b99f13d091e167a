"""Towards a goal, as far as it is possible."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import TypeVar

from coupling.ports import Array, StepFailed

HALVINGS = 4  # of the way to the goal, at most

_log = logging.getLogger(__name__)
Answer = TypeVar("Answer")


def nearest(ask: Callable[[Array], Answer], goal: Array, start: Array) -> Answer:
    """What ``ask`` says of ``goal`` (n, 3) [m], or half the way there from ``start``, and so on.

    Raises the ``StepFailed`` or ArithmeticError that ``ask`` fails with at the last.
    """
    for _ in range(HALVINGS):
        try:
            return ask(goal)
        except (StepFailed, ArithmeticError) as failure:
            _log.info("half the way is tried: %s", failure)
            goal = 0.5 * (start + goal)
    return ask(goal)
