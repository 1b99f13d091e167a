"""A tank shaken by a sine with a smooth start."""

from __future__ import annotations

import numpy as np

from coupling.motion.kind import Attitude, MotionKind, TankMotion
from coupling.motion.lever import LeverMotion
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


class SineAttitude:
    """A turn about ``axis`` (3,), of any length but 0, by a sine that starts as ``SineMotion``'s.

    ``frequency`` [Hz]; ``angle`` [rad], centre to peak; ``ramp`` in periods.
    """

    sampled = False

    def __init__(self, *, frequency: float, angle: float, axis: Array, ramp: float) -> None:
        x, y, z = self._axis = np.asarray(axis) / np.linalg.norm(axis)
        self._across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        self._angle = SineMotion(
            frequency=frequency, amplitude=angle, direction=self._axis, ramp=ramp
        )

    def matrix(self, time: float) -> Array:
        """R = 1 + sin(angle) K + (1 - cos(angle)) K^2, K v = axis x v (Rodrigues)."""
        angle = float(self._angle.displacement(time) @ self._axis)
        turned = np.sin(angle) * self._across
        turned += 2.0 * np.sin(0.5 * angle) ** 2 * (self._across @ self._across)
        return np.asarray(np.eye(3) + turned)

    def rate(self, time: float) -> Array:
        """Along the axis [rad/s]."""
        return self._angle.velocity(time)

    def acceleration(self, time: float) -> Array:
        """Along the axis [rad/s^2]."""
        return self._angle.acceleration(time)


class Sine(MotionKind):
    """amplitude * s(t) * sin(2 pi frequency t) along the section's direction.

    And, or in place of it, a turn by ``angle`` in time with it about the ``axis`` through a
    ``point`` of the tank, which moves so.
    """

    needs = ("frequency",)
    takes = ("amplitude", "angle", "point")
    gentler = "shake less (motion.amplitude, motion.angle)"

    def motion(self, section: Motion) -> TankMotion:
        """The sine of ``section``, at the tank's origin."""
        assert section.frequency is not None
        of_point = SineMotion(
            frequency=section.frequency,
            amplitude=section.amplitude or 0.0,
            direction=section.unit_direction,
            ramp=section.ramp,
        )
        turning = self.attitude(section)
        if turning is None or section.point is None:
            return of_point
        return LeverMotion(of_point, turning, np.array(section.point))

    def attitude(self, section: Motion) -> Attitude | None:
        """The turn of ``section``, None without an angle."""
        if not section.angle or section.frequency is None:
            return None
        return SineAttitude(
            frequency=section.frequency,
            angle=np.radians(section.angle),
            axis=np.array(section.axis),
            ramp=section.ramp,
        )

    def problems(self, section: Motion, end: float, step: float) -> list[str]:
        """Neither an amplitude nor an angle, an angle about no axis, an axis of no angle."""
        del end, step
        problems = []
        if section.amplitude is None and section.angle is None:
            description = type(section).model_fields["amplitude"].description
            problems.append(
                f'motion.amplitude: is required for kind = "sine". Give the {description}, or an '
                "angle of rotation (motion.angle)."
            )
        if section.angle is not None and not any(section.axis):
            problems.append(
                "motion.axis: must not be zero, got [0, 0, 0]. Give the axis that the tank turns "
                "about, such as [0.0, 1.0, 0.0]."
            )
        if section.angle is None:
            problems += [
                f"motion.{key}: is read beside an angle only. Give motion.angle, or leave the "
                f"{key} out."
                for key in ("axis", "point")
                if getattr(section, key) != type(section).model_fields[key].default
            ]
        return problems

    def frequency(self, section: Motion) -> float | None:
        """Of the sine [Hz]."""
        return section.frequency

    def peak_accelerations(self, section: Motion) -> Array:
        """A (2 pi f)^2 either way along the direction; what the smooth start adds is left out."""
        if not section.amplitude or not section.frequency:
            return np.zeros((1, 3))
        peak = section.amplitude * (2.0 * np.pi * section.frequency) ** 2
        return np.outer([peak, -peak], section.unit_direction)

    def instants(self, section: Motion) -> Array:
        """A period without the smooth start."""
        assert section.frequency is not None
        return (section.ramp + np.arange(48) / 48.0) / section.frequency

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """Frequency and amplitudes."""
        amplitude, angle = 1e3 * (section.amplitude or 0.0), section.angle
        facts = [(section.frequency or 0.0, "Hz")]
        if section.amplitude is not None or not angle:
            facts.append((amplitude, "mm centre to peak"))
        if angle:
            facts.append((angle, "degrees centre to peak"))
        return tuple(facts)


SINE = Sine()
