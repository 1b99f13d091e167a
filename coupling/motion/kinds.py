"""How the tank moves: displacement, velocity and acceleration of its centre.

Time 0 is the start of the shaking; the tank is at rest before. The tank does not rotate.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from scipy.interpolate import make_interp_spline

from coupling.ports import Array
from coupling.scene.motion_table import MotionTable
from coupling.scene.scene import Scene


class TankMotion(Protocol):
    """Motion of the tank's centre in the laboratory frame; ``time`` [s], all results (3,)."""

    def displacement(self, time: float) -> Array:
        """From where the tank stood at time 0 [m]."""

    def velocity(self, time: float) -> Array:
        """[m/s]."""

    def acceleration(self, time: float) -> Array:
        """[m/s^2]."""

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """The one that drives a time step from ``start`` to ``end`` [s], solved at its end.

        ``previous`` [s]: length of the step before, 0 where there was none.
        """

    def working_acceleration(self, start: float, end: float) -> Array:
        """The one whose product with what moves in the step is the tank's work."""


class RestMotion:
    """A tank that stands still."""

    def displacement(self, time: float) -> Array:
        """Zero [m]."""
        return np.zeros(3)

    def velocity(self, time: float) -> Array:
        """Zero [m/s]."""
        return np.zeros(3)

    def acceleration(self, time: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)


def smooth_ramp(time: float, duration: float) -> tuple[float, float, float]:
    """Quintic smoothstep 10 q^3 - 15 q^4 + 6 q^5 of q = time/duration and two time derivatives.

    0 before time 0, 1 after ``duration`` [s], and twice continuously differentiable.
    A duration of 0 gives a jump at time 0.
    """
    if time <= 0.0 < duration or time < 0.0:
        return 0.0, 0.0, 0.0
    if time >= duration:
        return 1.0, 0.0, 0.0
    q = time / duration
    value = q**3 * (10.0 - 15.0 * q + 6.0 * q**2)
    first = 30.0 * q**2 * (1.0 - q) ** 2 / duration
    second = 60.0 * q * (1.0 - q) * (1.0 - 2.0 * q) / duration**2
    return value, first, second


class SineMotion:
    """amplitude * s(t) * sin(2 pi frequency t) along ``direction``, s a quintic smoothstep.

    ``frequency`` [Hz]; ``amplitude`` [m], centre to peak; ``direction`` (3,), of any length but 0;
    ``ramp``: length of the smooth start in periods. Derivatives are exact; with a ramp the
    acceleration is continuous and starts from 0.
    """

    def __init__(
        self, *, frequency: float, amplitude: float, direction: Array, ramp: float
    ) -> None:
        self._omega = 2.0 * np.pi * frequency
        self._vector: Array = amplitude * np.asarray(direction) / np.linalg.norm(direction)
        self._ramp = ramp / frequency

    def _along(self, value: float) -> Array:
        return np.asarray(value * self._vector, dtype=np.float64)

    def displacement(self, time: float) -> Array:
        """s sin [m]."""
        s, _, _ = smooth_ramp(time, self._ramp)
        return self._along(s * np.sin(self._omega * time))

    def velocity(self, time: float) -> Array:
        """s' sin + s omega cos [m/s]."""
        s, s1, _ = smooth_ramp(time, self._ramp)
        w, angle = self._omega, self._omega * time
        return self._along(s1 * np.sin(angle) + s * w * np.cos(angle))

    def acceleration(self, time: float) -> Array:
        """s'' sin + 2 s' omega cos - s omega^2 sin [m/s^2]."""
        s, s1, s2 = smooth_ramp(time, self._ramp)
        w, angle = self._omega, self._omega * time
        return self._along((s2 - s * w**2) * np.sin(angle) + 2.0 * s1 * w * np.cos(angle))

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """At the end [m/s^2], where the step is solved: of second order, as that is."""
        return self.acceleration(end)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean of both ends [m/s^2]: the trapezoidal rule."""
        return 0.5 * (self.acceleration(start) + self.acceleration(end))


class TableMotion:
    """Tabulated accelerations, linear between them and integrated exactly.

    Displacement and velocity are 0 at time 0, so a table with a mean acceleration drifts away:
    what the liquid feels depends on the acceleration alone. Times outside the table extrapolate.
    """

    def __init__(self, table: MotionTable) -> None:
        linear = make_interp_spline(table.time, table.acceleration, k=1, axis=0)
        self._acceleration = linear
        self._velocity = linear.antiderivative(1)
        self._displacement = linear.antiderivative(2)

    def displacement(self, time: float) -> Array:
        """Second integral from time 0 [m]."""
        start = self._displacement(0.0) + self._velocity(0.0) * time
        return np.asarray(self._displacement(time) - start, dtype=np.float64)

    def velocity(self, time: float) -> Array:
        """First integral from time 0 [m/s]."""
        return np.asarray(self._velocity(time) - self._velocity(0.0), dtype=np.float64)

    def acceleration(self, time: float) -> Array:
        """Interpolated [m/s^2]."""
        return np.asarray(self._acceleration(time), dtype=np.float64)

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """Mean over the step, carried from its middle to its end [m/s^2].

        Carried along the line through the mean over the step before. This is the difference of the
        tank's velocity, the integral of the table, by the steps' own implicit formula
        (``cloth.inertia``): a body that nothing holds changes its velocity in every step by the
        integral over it, exactly. A sample would take what is faster than the steps for slow motion
        or miss it, and the mean alone, used at the step's end, would be late by half a step.
        """
        step = end - start
        mean = self.working_acceleration(start, end)
        if previous <= 0.0:
            return mean
        before = self.working_acceleration(start - previous, start)
        return mean + step / (step + previous) * (mean - before)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean over the step [m/s^2]: the tank's change of velocity over the step's length."""
        change = self._velocity(end) - self._velocity(start)
        return np.asarray(change / (end - start), dtype=np.float64)


def motion_of(scene: Scene) -> TankMotion:
    """The tank's motion that a scene describes."""
    motion = scene.motion
    if motion.kind == "table":
        return TableMotion(motion.record)
    if motion.kind == "sine":
        assert motion.frequency is not None
        assert motion.amplitude is not None
        return SineMotion(
            frequency=motion.frequency,
            amplitude=motion.amplitude,
            direction=motion.unit_direction,
            ramp=motion.ramp,
        )
    return RestMotion()
