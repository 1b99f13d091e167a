"""Hydrostatic liquid of constant volume: the datum is the volume's multiplier."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.ports import Array, HydrostaticLoad


@dataclass(frozen=True, kw_only=True)
class Hydrostatic:
    """p = p0(t) + rho b.x with V(x) = ``volume`` [m^3]; holds while (f/f1)^2 << 1.

    Also the part of the pressure that a flow model leaves out of its equations.
    """

    density: float
    volume: float

    def load(self, body_force: Array) -> HydrostaticLoad:
        """The load under ``body_force`` (3,) [m/s^2], gravity less the tank's acceleration."""
        return HydrostaticLoad(density=self.density, body_force=body_force, volume=self.volume)
