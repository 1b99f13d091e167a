"""A tank shaken by a sine with a smooth start."""

from __future__ import annotations

import numpy as np

from coupling.motion.kind import MotionKind, TankMotion
from coupling.ports import Array
from coupling.scene.sections import Motion


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


class Sine(MotionKind):
    """amplitude * s(t) * sin(2 pi frequency t) along the section's direction."""

    needs = ("frequency", "amplitude")
    gentler = "shake less (motion.amplitude)"

    def motion(self, section: Motion) -> TankMotion:
        """The sine of ``section``."""
        assert section.frequency is not None
        assert section.amplitude is not None
        return SineMotion(
            frequency=section.frequency,
            amplitude=section.amplitude,
            direction=section.unit_direction,
            ramp=section.ramp,
        )

    def frequency(self, section: Motion) -> float | None:
        """Of the sine [Hz]."""
        return section.frequency

    def peak_accelerations(self, section: Motion) -> Array:
        """A (2 pi f)^2 either way along the direction; what the smooth start adds is left out."""
        if not section.amplitude or not section.frequency:
            return np.zeros((1, 3))
        peak = section.amplitude * (2.0 * np.pi * section.frequency) ** 2
        return np.outer([peak, -peak], section.unit_direction)

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """Frequency and amplitude."""
        amplitude = 1e3 * (section.amplitude or 0.0)
        return (section.frequency or 0.0, "Hz"), (amplitude, "mm centre to peak")


SINE = Sine()
