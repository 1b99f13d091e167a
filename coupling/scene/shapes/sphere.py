"""A sphere, clamped at its equator or at another parallel circle."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from cloth.shell.sphere import Sphere
from coupling.scene.shapes.shape import TankShape, clamped

if TYPE_CHECKING:
    from cloth.shell.meridian import Meridian
    from coupling.scene.tank import Tank


def sphere_of(tank: Tank) -> Sphere | Meridian:
    """The sphere of the tank's radius; of two arcs where it is not clamped at the equator."""
    assert tank.radius is not None
    if tank.clamp_height == 0.0:
        return Sphere(tank.radius)
    from cloth.shell.pieces import arc

    quarter = 0.5 * math.pi
    ends = ((-quarter, 0.0), (0.0, quarter))
    return clamped([arc((0.0, 0.0), tank.radius, *angles) for angles in ends], tank)


SPHERE = TankShape(shell=sphere_of)
