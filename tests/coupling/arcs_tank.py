"""A shape of a tank for the tests: the sphere, of arcs."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from shells import sphere_of_arcs

from cloth.shell.meridian import Meridian
from coupling.scene.shapes import SHAPES
from coupling.scene.tank import Tank


def arcs_of(tank: Tank) -> Meridian:
    """The sphere of the tank's radius by its meridian, in four arcs."""
    return sphere_of_arcs(tank.radius)


@contextmanager
def arcs_offered() -> Iterator[None]:
    """While this lasts a scene may say ``tank.shape = "arcs"``."""
    SHAPES.add("arcs", "arcs_tank:arcs_of")
    try:
        yield
    finally:
        SHAPES.remove("arcs")
