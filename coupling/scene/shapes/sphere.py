"""A sphere, clamped at its equator."""

from __future__ import annotations

from cloth.shell.sphere import Sphere
from coupling.scene.tank import Tank


def sphere_of(tank: Tank) -> Sphere:
    """The sphere of the tank's radius."""
    return Sphere(tank.radius)
