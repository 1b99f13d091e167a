"""The thesis' liquid: hydrostatic below a level that a tank without diaphragm would have.

Kept for comparison. The source's Eqs. 4.3 to 4.5 write the fill fraction where the level is meant
and its code pushes the liquid along +a instead of -a; both are put right here. What is left is the
model's own: nothing conserves the liquid's volume, which drifts by -1 to +8 % in pad sway.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.ports import Array, HydrostaticLoad


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
