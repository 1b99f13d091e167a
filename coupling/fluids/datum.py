"""The thesis' liquid: hydrostatic below a level that a tank without diaphragm would have.

Kept for comparison. The source's Eqs. 4.3 to 4.5 write the fill fraction where the level is meant
and its code pushes the liquid along +a instead of -a; both are put right here. What is left is the
model's own: nothing conserves the liquid's volume, which drifts by -1 to +8 % in pad sway.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.fluids.model import FluidModel
from coupling.interface.liquid_shape import level_of_fill_fraction
from coupling.ports import Array, HydrostaticLoad
from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Datum:
    """p = rho (b.x + |b| level): zero on the plane at ``level`` [m] above the tank's centre.

    ``level`` is that of a spherical cap of the liquid's volume, whichever way b points (Eq. 4.5).
    """

    density: float
    level: float

    def load(self, body_force: Array) -> HydrostaticLoad:
        """The load under ``body_force`` (3,) [m/s^2], gravity less the tank's acceleration."""
        datum = self.density * float(np.linalg.norm(body_force)) * self.level
        return HydrostaticLoad(density=self.density, body_force=body_force, datum=datum)


class DatumModel(FluidModel):
    """The thesis' own liquid, the bottom of the ladder."""

    name = "datum"
    colour, line = "#CC79A7", ":"
    keeps_volume = False

    def load_model(self, scene: Scene) -> Datum:
        """Of the level that the scene's liquid would have without a diaphragm."""
        depth = level_of_fill_fraction(scene.liquid.fill_fraction)  # over R, from the bottom
        return Datum(density=scene.liquid.density, level=(depth - 1.0) * scene.tank.radius)


DATUM = DatumModel()
