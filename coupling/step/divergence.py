"""Which failures of a side are the coupling's own: those of iterates that diverge."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from coupling.ports import Cause, RunFailed, StepFailed


@contextmanager
def attributed_to_divergence(time: float, residuals: list[float]) -> Iterator[None]:
    """A side that fails where the iterates run away is the coupling's failure, not its own.

    ``time`` [s]; ``residuals``: what the iterations so far have left, relative.
    """
    try:
        yield
    except ArithmeticError as failure:
        if residuals:
            raise diverged_at(time, residuals) from failure
        raise
    except RunFailed as failure:
        if residuals and max(residuals) > 1.0:
            # Where the solver itself has died nothing is left to take the step in parts with.
            kind = StepFailed if isinstance(failure, StepFailed) else RunFailed
            raise diverged_at(time, residuals, kind) from failure
        raise


def diverged_at(
    time: float, residuals: list[float], kind: type[RunFailed] = StepFailed
) -> RunFailed:
    """The failure to raise at ``time`` [s], with the last of ``residuals``."""
    last = ", ".join(f"{residual:.1e}" for residual in residuals[-4:])
    return kind(
        f"t = {time:.6g} s: the coupling diverges: the last iterations left residuals of {last} "
        "times the step's own displacement.",
        cause=Cause.COUPLING,
    )
