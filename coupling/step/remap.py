"""When a step gets a new map, of where the structure has come to in place of the prediction."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.step.convergence import Convergence
from coupling.step.history import History


@dataclass(frozen=True, kw_only=True)
class RemapSettings:
    """Constants of the remapping, found by trial on violent sways.

    - ``slow``: iterations on a map before its rate is judged; the iteration stagnates where they
      have come less than half the way, in orders of magnitude (``Convergence.is_far``);
    - ``maps``: of a step, at most; with 1 the map of the step's start is kept. A violent sway
      from rest at a fill of 0.5 then takes up to 30 iterations in a step, the most allowed, in
      place of 14, and 4.15 on average in place of 3.93.
    """

    slow: int = 8
    maps: int = 3


class Remap:
    """The map of a step is that of the diaphragm's predicted position.

    Where the prediction is far off, iterations on its map diverge or stagnate.
    """

    def __init__(self, settings: RemapSettings) -> None:
        self.settings = settings

    def is_due(self, history: History, convergence: Convergence, *, diverged: bool) -> bool:
        """Whether a step with this ``history`` should go on, on a map made anew."""
        if len(history.maps) >= self.settings.maps:
            return False
        return diverged or (
            len(history.on_map) > self.settings.slow and convergence.is_far(history.on_map)
        )
