"""How much liquid there is in the tank, and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from coupling.scene.scene import Scene


class Supply(Protocol):
    """The liquid's volume as a function of time; 0 [s] is the start of the motion.

    One that varies takes a liquid without a flow: a flow's mesh is closed to the volume at the
    start, and the potential's walls have no outlet.
    """

    def volume(self, time: float) -> float:
        """[m^3] at ``time`` [s]."""


@dataclass(frozen=True)
class ClosedTank:
    """A tank from which nothing is drawn: always the same ``amount`` [m^3]."""

    amount: float

    def volume(self, time: float) -> float:
        """[m^3] at ``time`` [s]: the amount."""
        del time
        return self.amount


def supply_of(scene: Scene) -> Supply:
    """That of the scene's liquid."""
    return ClosedTank(scene.liquid_volume)
