"""How long a campaign will still take, from what its runs took so far."""

from __future__ import annotations

import time


class TimeLeft:
    """Estimates the time left from the estimated costs of what is done and what is to come.

    Costs are estimates, so it is one too.
    """

    def __init__(self) -> None:
        self._done = 0.0
        self._began = time.monotonic()

    def took(self, cost: float) -> None:
        """Count a run of this ``cost`` [s] as done."""
        self._done += cost

    def text(self, cost: float) -> str:
        """Return ", about 3 min left" where runs of ``cost`` [s] are to come; empty at the end."""
        seconds = self.seconds(cost)
        if seconds is None or seconds < 1.0:
            return ""
        for size, unit in ((3600.0, "h"), (60.0, "min")):
            if seconds >= 1.5 * size:
                return f", about {seconds / size:.0f} {unit} left"
        return f", about {seconds:.0f} s left"

    def seconds(self, cost: float) -> float | None:
        """Return the wall time [s] of runs of ``cost`` [s]; None as long as nothing is done."""
        if self._done <= 0.0:
            return None
        passed = time.monotonic() - self._began
        return cost / self._done * passed
