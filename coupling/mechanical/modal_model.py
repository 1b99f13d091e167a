"""A tank's liquid as a fixed mass and one to three pendulums: its answer in time and in frequency.

The formula is that of Dodge, The New "Dynamic Behavior of Liquids in Moving Containers" (SwRI,
2000), chapter 3, with a viscous damper beside each spring.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import expm
from scipy.signal import lfilter

from coupling.ports import Array

Complex = NDArray[np.complex128]


@dataclass(frozen=True, kw_only=True)
class ModalModel:
    """Apparent mass m0 + sum m_k (w_k^2 + 2 i z_k w_k w)/(w_k^2 - w^2 + 2 i z_k w_k w).

    ``total`` [kg]: mass of the liquid, m0 + sum m_k; ``masses`` (K,) [kg]: m_k; ``omegas`` (K,)
    [rad/s]: w_k; ``dampings`` (K,): z_k; ``heights`` (K + 1,) [m]: where the force of the fixed
    mass, then of each mode acts, above the tank's centre against gravity (a pendulum's hinge).
    """

    total: float
    masses: Array
    omegas: Array
    dampings: Array
    heights: Array

    @property
    def fixed(self) -> float:
        """Fixed mass m0 [kg]."""
        return float(self.total - self.masses.sum())

    def apparent_mass(self, omega: Array) -> Complex:
        """Apparent mass -F/a (n,) [kg] at angular frequencies ``omega`` (n,) [rad/s]."""
        return np.asarray(self.fixed + self._modal(omega).sum(axis=0), dtype=complex)

    def apparent_moment(self, omega: Array) -> Complex:
        """Apparent moment, that of the force about the tank's centre over -a (n,) [kg m]."""
        return np.asarray(
            self.heights[0] * self.fixed + self.heights[1:] @ self._modal(omega), dtype=complex
        )

    def _modal(self, omega: Array) -> Complex:
        """Part of each mode (K, n) [kg]."""
        square, s = self.omegas[:, None] ** 2, 1j * omega[None, :]
        damped = square + 2.0 * (self.dampings * self.omegas)[:, None] * s
        return np.asarray(self.masses[:, None] * damped / (damped + s**2), dtype=complex)

    def forces(self, acceleration: Array, step: float) -> Array:
        """Return the force of the fixed mass and of each mode on a tank that starts from rest.

        Parameters
        ----------
        acceleration
            Of the tank (n,) [m/s^2], at even instants from time 0 on, linear in between.
        step
            Time [s] between the instants.

        Returns
        -------
        Array
            Forces (K + 1, n) [N] along the direction of the acceleration.
        """
        parts = [
            mass * unit_force(omega, damping, acceleration, step)
            for mass, omega, damping in zip(self.masses, self.omegas, self.dampings, strict=True)
        ]
        return np.stack([-self.fixed * acceleration, *parts])


def unit_force(omega: float, damping: float, acceleration: Array, step: float) -> Array:
    """Force (n,) [N] of a mode of 1 kg: w^2 q + 2 z w q' with q'' + 2 z w q' + w^2 q = -a.

    ``omega`` [rad/s]; ``acceleration`` a (n,) [m/s^2] every ``step`` [s]. Exact for an
    acceleration that is linear between the instants and for rest at the first.
    """
    system = np.zeros((4, 4))  # q, q', a and what a changes by in a step
    system[0, 1] = step
    system[1] = -step * omega**2, -2.0 * step * damping * omega, -step, 0.0
    system[2, 3] = 1.0
    whole = expm(system)
    phi, before, slope = whole[:2, :2], whole[:2, 2], whole[:2, 3]
    # x_n+1 = phi x_n + (before - slope) a_n + slope a_n+1, as a filter of second order.
    out = np.array([omega**2, 2.0 * damping * omega])
    trace, determinant = float(np.trace(phi)), float(np.linalg.det(phi))
    adjugate = np.array([[phi[1, 1], -phi[0, 1]], [-phi[1, 0], phi[0, 0]]])
    early = before - slope
    carried = float(out @ adjugate @ slope)
    numerator = [float(out @ slope), float(out @ early) - carried, -float(out @ adjugate @ early)]
    first = float(acceleration[0])
    rest = [-numerator[0] * first, carried * first]  # the filter's memory, for q = q' = 0 at first
    return np.asarray(lfilter(numerator, [1.0, -trace, determinant], acceleration, zi=rest)[0])
