"""Wall time by part of a step."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from time import perf_counter


class Stopwatch:
    """Adds up the seconds spent in each of ``parts``."""

    def __init__(self, *parts: str) -> None:
        self._seconds = dict.fromkeys(parts, 0.0)

    @contextmanager
    def timed(self, part: str) -> Iterator[None]:
        """Add the time of what is done within to ``part``, also where that fails."""
        clock = perf_counter()
        try:
            yield
        finally:
            self._seconds[part] += perf_counter() - clock

    def taken(self) -> dict[str, float]:
        """Seconds by part since this was last asked."""
        taken, self._seconds = self._seconds, dict.fromkeys(self._seconds, 0.0)
        return taken
