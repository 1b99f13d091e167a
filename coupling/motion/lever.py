"""How the middle of a tank moves that turns about another of its points."""

from __future__ import annotations

import numpy as np

from coupling.motion.kind import Attitude, TankMotion
from coupling.motion.mean import carried_mean, mean_over
from coupling.ports import Array


class LeverMotion:
    """Motion of the origin of a tank with ``attitude`` whose ``point`` moves by ``of_point``.

    ``point`` P (3,) [m] in the tank's axes. The origin is where the point is less R P, so that its
    acceleration is the point's less R (alpha x P + omega x (omega x P)). Of an attitude that is
    sampled a step takes the mean of that, the change of velocity, as of a table's acceleration.
    """

    def __init__(self, of_point: TankMotion, attitude: Attitude, point: Array) -> None:
        self._of_point, self._attitude, self._point = of_point, attitude, point
        self._start = attitude.matrix(0.0) @ point

    def displacement(self, time: float) -> Array:
        """From where the origin stood at time 0 [m]."""
        turned = self._attitude.matrix(time) @ self._point - self._start
        return np.asarray(self._of_point.displacement(time) - turned)

    def velocity(self, time: float) -> Array:
        """[m/s]."""
        return np.asarray(self._of_point.velocity(time) + self._velocity(time))

    def _velocity(self, time: float) -> Array:
        """Of the origin less that of the point [m/s]."""
        turning = np.cross(self._attitude.rate(time), self._point)
        return np.asarray(-self._attitude.matrix(time) @ turning)

    def acceleration(self, time: float) -> Array:
        """[m/s^2]."""
        return np.asarray(self._of_point.acceleration(time) + self._acceleration(time))

    def _acceleration(self, time: float) -> Array:
        """Of the origin less that of the point [m/s^2]."""
        rate = self._attitude.rate(time)
        turning = np.cross(self._attitude.acceleration(time), self._point)
        turning = turning + np.cross(rate, np.cross(rate, self._point))
        return np.asarray(-self._attitude.matrix(time) @ turning)

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """At the end [m/s^2]; of samples the mean over the step, carried to its end."""
        of_point = self._of_point.step_acceleration(start, end, previous)
        if not self._attitude.sampled:
            return np.asarray(of_point + self._acceleration(end))
        return np.asarray(of_point + carried_mean(self._velocity, start, end, previous))

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean of both ends [m/s^2]; of samples the mean over the step."""
        of_point = self._of_point.working_acceleration(start, end)
        if not self._attitude.sampled:
            return np.asarray(
                of_point + 0.5 * (self._acceleration(start) + self._acceleration(end))
            )
        return np.asarray(of_point + mean_over(self._velocity, start, end))
