"""How a run fails, and what made it."""

from __future__ import annotations

from enum import Enum


class Cause(Enum):
    """What made a run fail, where what helps depends on its scene: ``mends`` knows that."""

    COUPLING = "the coupling diverges"
    MESH = "no mesh of the liquid is valid"
    FLOW = "the flow diverges"
    SHEET = "the diaphragm's inner iteration diverges"


class RunFailed(Exception):  # noqa: N818 - named for what a user reads
    """A run that cannot go on; the message says when and what, and the mend unless it has a cause.

    ``cause``: the mend is ``mends.mend``'s, which knows the scene.
    """

    def __init__(self, message: str = "", *, cause: Cause | None = None) -> None:
        super().__init__(message)
        self.cause = cause


class StepFailed(RunFailed):
    """A step that may succeed in parts: both sides stand where it began."""
