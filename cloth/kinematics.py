"""Kinematics of the implicit step: those of OpenFOAM's ``backward`` (second order, any dt)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from cloth.arrays import Array
from cloth.rotation import rotation_matrix


@dataclass(frozen=True, kw_only=True)
class Kinematics:
    """Velocity and acceleration as functions of the position at the step's end.

    v = (x - position_anchor) / b and a = (v - velocity_anchor) / b with b = dt / c, where
    c v dt = c x - c0 x_n + c00 x_(n-1). Uniform steps: c = 3/2, b = 2 dt/3 (BDF2). Without a
    previous step: c = 1 (implicit Euler), as OpenFOAM starts too.

    ``extrapolation`` (n, 3) [m]: where the explicit formula of the same order leads, Adams and
    Bashforth's (forward Euler); ``error_share``: of the distance from there, the step's own error
    (Milne's device; Gresho, Lee & Sani, Recent Advances in Numerical Methods in Fluids 1, 1980).
    """

    b: float
    position_anchor: Array
    velocity_anchor: Array
    extrapolation: Array
    error_share: float

    @property
    def prediction(self) -> Array:
        """Position x~ (n, 3) [m] without acceleration: that at x is (x - x~) / b^2."""
        return self.position_anchor + self.b * self.velocity_anchor

    def velocity(self, position: Array) -> Array:
        """Return the velocity (n, 3) [m/s] at the step's end, at ``position`` (n, 3) [m]."""
        return (position - self.position_anchor) / self.b

    def turned(self, rotation: Array) -> Kinematics:
        """The same in the axes that are turned by a ``rotation`` vector (3,) [rad]."""
        if not rotation.any():
            return self
        matrix = rotation_matrix(rotation)
        return replace(
            self,
            position_anchor=self.position_anchor @ matrix,
            velocity_anchor=self.velocity_anchor @ matrix,
            extrapolation=self.extrapolation @ matrix,
        )

    def local_error(self, position: Array) -> float:
        """Return the rms error [m] that the step adds by its length, at ``position`` (n, 3) [m]."""
        away = position - self.extrapolation
        return self.error_share * float(np.sqrt(np.mean(np.sum(away * away, axis=1))))


def kinematics(
    dt: float,
    previous_dt: float,
    position: Array,
    velocity: Array,
    previous_position: Array,
    previous_velocity: Array,
) -> Kinematics:
    """Return the kinematics of a step from the positions and velocities at its start and before.

    Coefficients as in OpenFOAM's backwardDdtScheme: c = 1 + dt/(dt + dt0),
    c00 = dt^2/(dt0 (dt + dt0)), c0 = c + c00.

    Parameters
    ----------
    dt
        Length of the step [s].
    previous_dt
        Length dt0 of the step before [s]; 0 when there was none, which gives implicit Euler.
    position, velocity
        At the step's start (n, 3) [m, m/s].
    previous_position, previous_velocity
        At the start of the step before (n, 3) [m, m/s].
    """
    if previous_dt <= 0.0:
        return Kinematics(
            b=dt, position_anchor=position, velocity_anchor=velocity,
            extrapolation=position + dt * velocity, error_share=0.5,
        )  # fmt: skip
    c = 1.0 + dt / (dt + previous_dt)
    c00 = dt * dt / (previous_dt * (dt + previous_dt))
    c0 = c + c00
    ratio = dt / previous_dt
    # Of dt^3 x'''.
    own, other = (
        (1.0 + ratio) ** 2 / (6.0 * ratio * (1.0 + 2.0 * ratio)),
        (2.0 + 3.0 / ratio) / 12.0,
    )
    return Kinematics(
        b=dt / c,
        position_anchor=(c0 * position - c00 * previous_position) / c,
        velocity_anchor=(c0 * velocity - c00 * previous_velocity) / c,
        extrapolation=position + dt * (velocity + 0.5 * ratio * (velocity - previous_velocity)),
        error_share=own / (own + other),
    )
