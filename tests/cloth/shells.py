"""Shells by their meridian, for the tests: a sphere of arcs, and a pill."""

from __future__ import annotations

import itertools
import math

from cloth.shell.meridian import Meridian
from cloth.shell.pieces import arc, line


def sphere_of_arcs(radius: float, cuts: tuple[float, ...] = (-0.7, 0.2, 0.9)) -> Meridian:
    """The sphere of ``radius`` [m], its meridian cut into arcs at angles [rad] from the equator."""
    angles = [-0.5 * math.pi, *cuts, 0.5 * math.pi]
    ends = itertools.pairwise(angles)
    return Meridian([arc((0.0, 0.0), radius, start, end) for start, end in ends])


def pill(radius: float, half: float) -> Meridian:
    """A cylinder of ``radius`` and twice ``half`` the length [m] between two half spheres."""
    quarter = 0.5 * math.pi
    return Meridian(
        [
            arc((0.0, -half), radius, -quarter, 0.0),
            line((radius, -half), (radius, half)),
            arc((0.0, half), radius, 0.0, quarter),
        ]
    )
