"""How the tank's axes turn in a time step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.ports.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Turn:
    """How a tank turns in a step, whose nodes are those in the tank's own axes.

    Positions are in the tank's axes of their own instant. Newton's law holds in axes that do not
    turn, so a step takes what it remembers, positions and velocities alike, into the tank's axes at
    the step's end, x -> Q x, and is solved there: there the shell and the rim stand where they
    always do.

    ``last`` and ``before`` (3, 3): Q from the axes at the step's start, and at the start of the
    step before. ``attitude`` (3, 3): R from the axes at the step's end to those at time 0.
    ``rate`` and ``acceleration`` (3,) [rad/s, rad/s^2]: of the tank at the step's end, in its axes
    then.
    """

    attitude: Array
    last: Array
    before: Array
    rate: Array
    acceleration: Array

    def velocity(self, points: Array) -> Array:
        """Of ``points`` (n, 3) [m] of the tank at the step's end [m/s]."""
        return np.asarray(np.cross(self.rate, points))

    def acceleration_at(self, points: Array) -> Array:
        """Of ``points`` (n, 3) [m] of the tank at the step's end [m/s^2]."""
        turning = np.cross(self.acceleration, points)
        return np.asarray(turning + np.cross(self.rate, self.velocity(points)))
