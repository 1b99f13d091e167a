"""An ellipsoid of revolution, by smooth arcs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cloth.shell.arc_spline import ellipse
from coupling.scene.shapes.shape import TankShape, clamped

if TYPE_CHECKING:
    from cloth.shell.meridian import Meridian
    from coupling.scene.tank import Tank


def ellipsoid_of(tank: Tank) -> Meridian:
    """The ellipsoid of the tank's radius and ``semi_axis``, its axis of revolution along z."""
    assert tank.radius is not None
    assert tank.semi_axis is not None
    return clamped(ellipse(tank.radius, tank.semi_axis), tank)


ELLIPSOID = TankShape(shell=ellipsoid_of, needs=("radius", "semi_axis"))
