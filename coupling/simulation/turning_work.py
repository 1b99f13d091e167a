"""What a tank that turns does on what it holds.

At the angular velocity omega it is T . omega. The torque T about the origin is what changes the
sheet's angular momentum L, less what liquid and weight do: T = dL/dt - M - sum x_i x m_i b, with
the moment M of the liquid's pressure on sheet and shell together. The liquid's own angular momentum
is in M.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from coupling.ports import Array, DiaphragmState, HydrostaticLoad, LiquidSample
from coupling.structure.diaphragm import Diaphragm


class Turning(Protocol):
    """The ``rate``, ``spin`` and ``torque`` of ``energy.Instant``, (3,) each."""

    @property
    def rate(self) -> Array:
        """Of the tank [rad/s]."""

    @property
    def spin(self) -> Array:
        """Angular momentum of the sheet [kg m^2/s]."""

    @property
    def torque(self) -> Array:
        """Of liquid and weight on shell and sheet [N m]."""


def work_of_turning(dt: float, before: Turning, now: Turning) -> float:
    """What the tank's torque does [J] in a step of ``dt`` [s] between two instants."""
    turned = 0.5 * (before.rate + now.rate)
    given = float(turned @ (now.spin - before.spin))
    return given - 0.5 * dt * float(before.torque @ before.rate + now.torque @ now.rate)


def turning_at(
    cloth: Diaphragm,
    state: DiaphragmState,
    liquid: LiquidSample | None,
    load: HydrostaticLoad,
    moment: Array,
    turned: tuple[Array, Array],
) -> dict[str, Array]:
    """What an ``Instant`` knows of a tank that turns, from its ``moment`` (2, 3) [kg m]."""
    ground, rate = turned
    spin = cloth.mass @ np.cross(state.position, state.velocity)
    torque = np.cross(moment.sum(axis=0), ground @ load.body_force)
    if liquid is not None:
        torque = torque + ground @ liquid.wall_pressure_moment
    return {"rate": ground @ rate, "spin": ground @ spin, "torque": torque}
