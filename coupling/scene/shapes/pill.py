"""A pill: a cylinder between two half spheres."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from cloth.shell.pieces import arc, line
from coupling.scene.shapes.shape import TankShape, clamped

if TYPE_CHECKING:
    from cloth.shell.meridian import Meridian
    from coupling.scene.tank import Tank


def pill_of(tank: Tank) -> Meridian:
    """The pill of the tank's radius and ``cylinder_length``, its axis along z."""
    assert tank.radius is not None
    assert tank.cylinder_length is not None
    radius, half, quarter = tank.radius, 0.5 * tank.cylinder_length, 0.5 * math.pi
    side = [line((radius, -half), (radius, half))] if half > 0.0 else []
    lower = arc((0.0, -half), radius, -quarter, 0.0)
    return clamped([lower, *side, arc((0.0, half), radius, 0.0, quarter)], tank)


PILL = TankShape(shell=pill_of, needs=("radius", "cylinder_length"))
