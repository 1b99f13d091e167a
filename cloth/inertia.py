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
        """x~ (n, 3) [m]: the acceleration at x is (x - x~) / b^2."""
        return self.position_anchor + self.b * self.velocity_anchor

    def velocity(self, position: Array) -> Array:
        """(n, 3) [m/s]."""
        return (position - self.position_anchor) / self.b


def kinematics(
    dt: float,
    previous_dt: float,
    position: Array,
    velocity: Array,
    previous_position: Array,
    previous_velocity: Array,
) -> Kinematics:
    """The step of ``dt`` [s] after one of ``previous_dt`` [s], 0 when there was none.

    Coefficients as in OpenFOAM's backwardDdtScheme: c = 1 + dt/(dt + dt0),
    c00 = dt^2/(dt0 (dt + dt0)), c0 = c + c00.
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
