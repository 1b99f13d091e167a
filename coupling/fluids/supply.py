"""How much liquid there is in the tank, and when."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from coupling.ports import Array
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


@dataclass(frozen=True)
class DrawnTank:
    """A tank whose volume falls evenly from ``start`` to ``end`` [m^3] in ``duration`` [s]."""

    start: float
    end: float
    duration: float

    def volume(self, time: float) -> float:
        """[m^3] at ``time`` [s]; that of the end afterwards, exactly."""
        share = min(time / self.duration, 1.0)
        return (1.0 - share) * self.start + share * self.end


def supply_of(scene: Scene) -> Supply:
    """That of the scene's liquid."""
    end, duration = scene.supply.end_fill_fraction, scene.supply.duration
    if end is None or duration is None:
        return ClosedTank(scene.liquid_volume)
    return DrawnTank(scene.liquid_volume, end * scene.tank.volume, duration)


def volume_error(scene: Scene, time: Array, volume: Array) -> Array:
    """Error (S,) of a ``volume`` (S,) [m^3] at ``time`` (S,) [s], relative to what is left."""
    supply = supply_of(scene)
    left = np.array([supply.volume(float(one)) for one in time])
    return np.asarray(np.abs(volume / left - 1.0))
