"""Shapes of a tank, by the name that ``tank.shape`` chooses.

A shape is one file with a ``TankShape``, and one line in ``SHAPES``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from coupling.registry import Registry

if TYPE_CHECKING:
    from coupling.scene.shapes.shape import TankShape

__all__ = ["SHAPES"]

SHAPES: Registry[TankShape] = Registry(
    "shape of a tank",
    {
        "sphere": "coupling.scene.shapes.sphere:SPHERE",
        "pill": "coupling.scene.shapes.pill:PILL",
        "ellipsoid": "coupling.scene.shapes.ellipsoid:ELLIPSOID",
        "profile": "coupling.scene.shapes.profile:PROFILE",
    },
)
