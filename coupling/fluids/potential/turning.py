"""What a potential step remembers, in the axes of a tank that has turned."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.ports import Array, Turn

_LAST = ("position", "velocity", "force")
_BEFORE = ("previous_position", "previous_velocity")


def in_tank(velocity: Array, points: Array, turn: Turn | None) -> Array:
    """Return the velocity of nodes relative to the tank.

    Parameters
    ----------
    velocity, points
        Of the nodes (n, 3) [m/s], in axes that do not turn, and where they are (n, 3) [m].
    turn
        How the tank turns, None where it does not.

    Returns
    -------
    Array
        Velocity (n, 3) [m/s].
    """
    return velocity if turn is None else velocity - turn.velocity(points)


class TurnedHarmonics:
    """Turns combinations of ``harmonics`` into other axes: those of one degree among themselves.

    They are orthonormal over the sphere of their radius. Gauss' points in height and as many even
    azimuths as it takes make the sums over products of two of them exact.
    """

    def __init__(self, harmonics: SolidHarmonics) -> None:
        degree = harmonics.degree
        height, weight = np.polynomial.legendre.leggauss(degree + 1)
        azimuth = 2.0 * np.pi * np.arange(2 * degree + 1) / (2 * degree + 1)
        z, a = (part.ravel() for part in np.meshgrid(height, azimuth, indexing="ij"))
        reach = np.sqrt(1.0 - z * z)
        unit = np.column_stack([reach * np.cos(a), reach * np.sin(a), z])
        self._points = harmonics.radius * unit
        self._values = harmonics.values
        share = np.repeat(0.5 * weight, len(azimuth)) / len(azimuth)
        self._projection = self._values(self._points).T * share

    def turned(self, coefficients: Array, matrix: Array) -> Array:
        """Return the coefficients (k,) in other axes, in which x is ``matrix`` x, (3, 3)."""
        there = self._values(self._points @ matrix) @ coefficients
        return np.asarray(self._projection @ there)

    def history(self, now: Mapping[str, Array], turn: Turn) -> dict[str, Array]:
        """Return what ``now`` holds, vectors and potentials alike, in the axes of a step's end."""
        found = dict(now)
        for names, matrix in ((_LAST, turn.last), (_BEFORE, turn.before)):
            found |= {name: np.asarray(now[name] @ matrix.T) for name in names}
        return found | {
            "coefficient": self.turned(now["coefficient"], turn.last),
            "previous_coefficient": self.turned(now["previous_coefficient"], turn.before),
        }
