"""What carries the tank of a scene."""

from __future__ import annotations

import numpy as np

from coupling.motion.carrier import Carrier, Prescribed
from coupling.motion.frame import Frame
from coupling.motion.free_tank import FreeTank
from coupling.scene.scene import Scene


def carrier_of(scene: Scene, frame: Frame, *, sheet: float, felt: bool) -> Carrier:
    """Return the carrier of a ``scene``; a free one knows what the tank contains.

    ``sheet`` [kg]: mass of the diaphragm; ``felt``: whether the liquid has a momentum of its own in
    the tank, which the tank feels.
    """
    section, density = scene.carrier, scene.liquid.density
    if section.mass is None:
        return Prescribed(frame)
    return FreeTank(
        section, frame, mass=section.mass + density * scene.liquid_volume + sheet,
        density=density if felt else 0.0,
        below_rim=np.array([0.0, 0.0, scene.tank.shell.moment_below(0.0)]),
    )  # fmt: skip
