"""Kinematics of the implicit step: those of OpenFOAM's ``backward`` (second order, any dt)."""

from __future__ import annotations

from dataclasses import dataclass

from cloth.arrays import Array


@dataclass(frozen=True, kw_only=True)
class Kinematics:
    """Velocity and acceleration as functions of the position at the step's end.

    v = (x - position_anchor) / b and a = (v - velocity_anchor) / b with b = dt / c, where
    c v dt = c x - c0 x_n + c00 x_(n-1). Uniform steps: c = 3/2, b = 2 dt/3 (BDF2). Without a
    previous step: c = 1 (implicit Euler), as OpenFOAM starts too.
    """

    b: float
    position_anchor: Array
    velocity_anchor: Array

    @property
    def prediction(self) -> Array:
        """Position x~ (n, 3) [m] without acceleration: that at x is (x - x~) / b^2."""
        return self.position_anchor + self.b * self.velocity_anchor

    def velocity(self, position: Array) -> Array:
        """Return the velocity (n, 3) [m/s] at the step's end, at ``position`` (n, 3) [m]."""
        return (position - self.position_anchor) / self.b


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
        return Kinematics(b=dt, position_anchor=position, velocity_anchor=velocity)
    c = 1.0 + dt / (dt + previous_dt)
    c00 = dt * dt / (previous_dt * (dt + previous_dt))
    c0 = c + c00
    return Kinematics(
        b=dt / c,
        position_anchor=(c0 * position - c00 * previous_position) / c,
        velocity_anchor=(c0 * velocity - c00 * previous_velocity) / c,
    )
