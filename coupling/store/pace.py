"""How often a job is done whose cost is known only once it has been done."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter


class Pace:
    """Tells when a repeated job is due, so that it takes a ``share`` of the wall time at most.

    It is due as soon as the time since its last end is its last duration over ``share``; at
    first it is due at once.
    """

    def __init__(self, share: float) -> None:
        self._share = share
        self._due_at = float("-inf")  # perf_counter [s]

    @property
    def due(self) -> bool:
        """Whether the job should be done now."""
        return perf_counter() >= self._due_at

    @contextmanager
    def timed(self) -> Iterator[None]:
        """Do the job within this context, which measures what it costs."""
        start = perf_counter()
        yield
        end = perf_counter()
        self._due_at = end + (end - start) / self._share
