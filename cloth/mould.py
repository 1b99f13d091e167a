"""The shape in which a diaphragm is moulded: an open surface of revolution that ends at its rim."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cloth.arrays import Array


class Mould(Protocol):
    """A moulded sheet: a meridian, from the pole on the z axis to the rim in the plane z = 0."""

    @property
    def length(self) -> float:
        """Length of the meridian [m]."""

    def ring(self, number: int, rings: int) -> tuple[float, float]:
        """Return radius and height [m] of a point of the meridian, a parallel circle of the mould.

        It is the one after ``number`` of ``rings`` even parts of the meridian, from the pole.
        """

    def directions(self, points: Array) -> Array:
        """Map ``points`` (n, 3) [m] of the mould to the unit hemisphere (n, 3), as its chart.

        At the same azimuth, at the polar angle pi/2 s/length for an arc length s from the pole.
        """


@dataclass(frozen=True)
class Hemisphere:
    """The hemisphere z >= 0 of ``radius`` [m]."""

    radius: float

    @property
    def length(self) -> float:
        """Length of the meridian [m]."""
        return 0.5 * math.pi * self.radius

    def ring(self, number: int, rings: int) -> tuple[float, float]:
        """Return radius and height [m] of a parallel circle, see ``Mould``; exact at the rim."""
        if number == rings:
            return self.radius, 0.0
        polar = number * (0.5 * np.pi / rings)
        return self.radius * float(np.sin(polar)), self.radius * float(np.cos(polar))

    def directions(self, points: Array) -> Array:
        """Map ``points`` (n, 3) [m] of the mould to the unit hemisphere (n, 3), as its chart."""
        return np.asarray(points / self.radius)
