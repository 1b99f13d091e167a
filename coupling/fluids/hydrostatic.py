"""Hydrostatic liquid of constant volume: the datum is the volume's multiplier."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.fluids.model import ErrorLaw, FluidModel, inertia_left_out
from coupling.ports import Array, HydrostaticLoad
from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Hydrostatic:
    """p = p0(t) + rho b.x with V(x) that of the supply; holds while (f/f1)^2 << 1.

    Also the part of the pressure that a flow model leaves out of its equations.
    """

    density: float

    def load(self, body_force: Array, volume: float) -> HydrostaticLoad:
        """The load of ``volume`` [m^3] under ``body_force`` (3,) [m/s^2]."""
        return HydrostaticLoad(density=self.density, body_force=body_force, volume=volume)


def hydrostatic_of(scene: Scene) -> Hydrostatic:
    """The hydrostatic pressure of the scene's liquid."""
    return Hydrostatic(density=scene.liquid.density)


class HydrostaticModel(FluidModel):
    """The assumption that is put to the test."""

    name = "hydrostatic"
    colour, line = "#D55E00", "--"
    takes_supply = True
    error_law = ErrorLaw(law=inertia_left_out, adds_next=True)

    def load_model(self, scene: Scene) -> Hydrostatic:
        """Return the hydrostatic pressure of the scene's liquid."""
        return hydrostatic_of(scene)


HYDROSTATIC = HydrostaticModel()
