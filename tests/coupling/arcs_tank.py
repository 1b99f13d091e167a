"""A shape of a tank for the tests: the sphere, of arcs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from shells import sphere_of_arcs

from cloth.shell.meridian import Meridian
from coupling.scene.shapes import SHAPES
from coupling.scene.shapes.shape import TankShape
from coupling.scene.tank import Tank


def arcs_of(tank: Tank) -> Meridian:
    """The sphere of the tank's radius by its meridian, in four arcs."""
    assert tank.radius is not None
    return sphere_of_arcs(tank.radius)


ARCS = TankShape(shell=arcs_of)


@contextmanager
def arcs_offered() -> Iterator[None]:
    """While this lasts a scene may say ``tank.shape = "arcs"``."""
    SHAPES.add("arcs", "arcs_tank:ARCS")
    try:
        yield
    finally:
        SHAPES.remove("arcs")
