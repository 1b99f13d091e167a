"""The thesis' liquid: hydrostatic below a level that a tank without diaphragm would have.

Kept for comparison. The source's Eqs. 4.3 to 4.5 write the fill fraction where the level is meant
and its code pushes the liquid along +a instead of -a; both are put right here. What is left is the
model's own: nothing conserves the liquid's volume, which drifts by -1 to +8 % in pad sway.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.fluids.model import FluidModel
from coupling.ports import Array, HydrostaticLoad, Shell
from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Datum:
    """p = rho (b.x + |b| level): zero on the plane at ``level`` [m] above the origin, against b.

    There a level liquid would have its surface in the ``shell`` (Eq. 4.5, of a sphere, where it
    stands as high whichever way b points).
    """

    density: float
    shell: Shell

    def load(self, body_force: Array, volume: float) -> HydrostaticLoad:
        """The load of ``volume`` [m^3] under ``body_force`` (3,) [m/s^2]."""
        level = self.shell.level_of(volume, -body_force)
        datum = self.density * float(np.linalg.norm(body_force)) * level
        return HydrostaticLoad(density=self.density, body_force=body_force, datum=datum)


class DatumModel(FluidModel):
    """The thesis' own liquid, the bottom of the ladder."""

    name = "datum"
    settling = 2.5  # measured at 16 rings
    colour, line = "#CC79A7", ":"
    keeps_volume = False

    def load_model(self, scene: Scene) -> Datum:
        """Of the level that the scene's liquid would have without a diaphragm."""
        return Datum(density=scene.liquid.density, shell=scene.tank.shell)


DATUM = DatumModel()
