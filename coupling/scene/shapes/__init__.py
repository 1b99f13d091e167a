"""Shapes of a tank, by the name that ``tank.shape`` chooses.

A shape is one file with a function from the section [tank] to its shell, and one line in
``SHAPES``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from coupling.registry import Registry

if TYPE_CHECKING:
    from collections.abc import Callable

    from coupling.scene.tank import Tank, TankShell

__all__ = ["SHAPES"]

SHAPES: Registry[Callable[[Tank], TankShell]] = Registry(
    "shape of a tank",
    {
        "sphere": "coupling.scene.shapes.sphere:sphere_of",
    },
)
