"""Samples of a shell below a plane however it lies, and of the plane's part inside the shell.

Circles of the shell are cut by a chord; along the meridian Gauss's rule stands between the heights
at which the plane leaves them, in a variable that takes their roots away.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cloth.arrays import Array
from cloth.shell.pieces import arc, crossings, piece_length, piece_points

NODES = 16  # of Gauss's rule beyond the degree, on a third of the meridian or more
FEWEST = 6  # on a part of a piece, however short
VOLUME = 48  # of Gauss's rule on any part, however short, for a volume
LEAST = 1e-300  # for a division
LEVEL = 1e-12  # sine of the angle below which a plane is level


@dataclass(frozen=True, kw_only=True)
class Plane:
    """The plane at ``level`` [m] above the origin along ``up`` (3,), of length 1."""

    up: Array
    level: float

    @property
    def lean(self) -> float:
        """Sine of the angle between ``up`` and the axis of revolution."""
        return float(np.hypot(self.up[0], self.up[1]))

    @property
    def across(self) -> Array:
        """Unit vectors (2, 3) across the axis, towards ``up`` and level."""
        x, y = (self.up[:2] / self.lean) if self.lean > LEVEL else (1.0, 0.0)
        return np.array([[x, y, 0.0], [-y, x, 0.0]])


@dataclass(frozen=True, kw_only=True)
class _Circles:
    """Circles (n,) of the meridian: r and z [m], the normal's parts, ds [m], half the dry angle."""

    r: Array
    z: Array
    nr: Array
    nz: Array
    ds: Array
    dry: Array


def meridian_of(profile: Array) -> Array:
    """Return the pieces (k, 7) of a shell's ``profile``, a sphere's two quarter circles."""
    if profile.shape[1] > 1:
        return profile
    radius, quarter = float(profile[0, 0]), 0.5 * math.pi
    ends = (-quarter, 0.0), (0.0, quarter)
    return np.array([arc((0.0, 0.0), radius, start, end) for start, end in ends])


@lru_cache
def _gauss(count: int) -> tuple[Array, Array]:
    """Nodes and weights (n,) of Gauss's rule between -1 and 1."""
    return np.polynomial.legendre.leggauss(count)


def _circles(pieces: Array, plane: Plane, nodes: int, fewest: int = FEWEST) -> Iterator[_Circles]:
    """By part of a piece between two crossings with the plane.

    Gauss's rule has ``fewest`` nodes on each, and ``nodes`` more on a third of the meridian.
    """
    lengths, rise = [piece_length(piece) for piece in pieces], float(plane.up[2])
    for piece, length in zip(pieces, lengths, strict=True):
        for low, high in itertools.pairwise(crossings(piece, plane.level, plane.lean, rise)):
            part = min(1.0, 3.0 * (high - low) * length / sum(lengths))
            node, weight = _gauss(fewest + math.ceil(part * nodes))
            angle = 0.25 * np.pi * (1.0 + node)
            share = low + (high - low) * np.sin(angle) ** 2
            r, z, nr, nz = piece_points(np.tile(piece, (len(node), 1)), share)
            ds = 0.25 * np.pi * length * (high - low) * np.sin(2.0 * angle) * weight
            with np.errstate(over="ignore"):  # of a level plane all of a circle is on one side
                chord = (plane.level - rise * z) / np.maximum(plane.lean * r, LEAST)
            chord = np.clip(chord, -1.0, 1.0)
            yield _Circles(r=r, z=z, nr=nr, nz=nz, ds=ds, dry=np.arccos(chord))


def volume_under(profile: Array, plane: Plane) -> float:
    """Return the volume [m^3] of a shell's inside below a plane, to rounding.

    Below a level one 1e-13 of a quarter circle's is missed, by where that meets the plane. By the
    divergence theorem for the distance from the axis, of circles' wetted parts; ``profile`` and
    ``plane`` as of ``wetted_samples``.
    """
    return sum(
        float(np.sum(c.r**2 * (np.pi - c.dry + np.sin(c.dry) * np.cos(c.dry)) * c.nr * c.ds))
        for c in _circles(meridian_of(profile), plane, 0, VOLUME)
    )


def wetted_samples(profile: Array, plane: Plane, degree: int) -> tuple[Array, Array]:
    """Return samples of a shell below a plane.

    Parameters
    ----------
    profile
        The shell, as ``cloth.shell.kernels`` describes it.
    plane
        The plane; what lies against its ``up`` is wetted.
    degree
        The samples are for products of two polynomials of this degree, one times the normal: of
        which some 1e-12 is missed.

    Returns
    -------
    points : Array
        Points (n, 3) [m].
    area : Array
        Their outward area vectors (n, 3) [m^2].
    """
    node, weight = np.polynomial.legendre.leggauss(3 * degree + NODES)
    towards, level = plane.across
    points, areas = [np.zeros((0, 3))], [np.zeros((0, 3))]
    for part in _circles(meridian_of(profile), plane, degree + NODES):
        if (part.dry >= np.pi).all():
            continue
        half = np.pi - part.dry
        angle = np.pi + half[:, None] * node  # from the direction of ``towards``
        way = np.cos(angle)[..., None] * towards + np.sin(angle)[..., None] * level
        size = (part.r * part.ds * half)[:, None] * weight
        axis = np.array([0.0, 0.0, 1.0])
        points.append((part.r[:, None, None] * way + part.z[:, None, None] * axis).reshape(-1, 3))
        normal = part.nr[:, None, None] * way + part.nz[:, None, None] * axis
        areas.append((size[..., None] * normal).reshape(-1, 3))
    return np.concatenate(points), np.concatenate(areas)


def section_samples(profile: Array, plane: Plane, degree: int) -> tuple[Array, Array]:
    """Return samples of the part of a plane that lies inside a shell.

    Parameters
    ----------
    profile, plane, degree
        As of ``wetted_samples``, the products without a normal.

    Returns
    -------
    points : Array
        Points (n, 3) [m].
    size : Array
        Their areas (n,) [m^2].
    """
    node, weight = np.polynomial.legendre.leggauss(degree + NODES)
    (towards, level), axis = plane.across, np.array([0.0, 0.0, 1.0])
    pieces = meridian_of(profile)
    if plane.lean <= LEVEL:
        return _disc(pieces, plane, degree)
    points, sizes = [np.zeros((0, 3))], [np.zeros(0)]
    for part in _circles(pieces, plane, degree + NODES):
        cut = (part.dry > 0.0) & (part.dry < np.pi)
        r, z, dry = part.r[cut], part.z[cut], part.dry[cut]
        half = r * np.sin(dry)
        place = (r * np.cos(dry))[:, None] * towards + z[:, None] * axis
        points.append((place[:, None] + (half[:, None] * node)[..., None] * level).reshape(-1, 3))
        # Up the plane dz is the sine of its slope, and dz = n_r ds along the meridian.
        size = part.nr[cut] * part.ds[cut] * half / plane.lean
        sizes.append((size[:, None] * weight).ravel())
    return np.concatenate(points), np.concatenate(sizes)


def _disc(pieces: Array, plane: Plane, degree: int) -> tuple[Array, Array]:
    """Samples of the disc in which a level plane cuts the shell."""
    height, count = plane.level / float(plane.up[2]), 2 * degree + 2
    node, weight = np.polynomial.legendre.leggauss(degree + 2)
    radius = 0.0
    for piece in pieces:
        if piece[1] <= height <= piece[3]:
            share = crossings(piece, height, 0.0, 1.0)
            r, z, _, _ = piece_points(np.tile(piece, (len(share), 1)), np.array(share))
            radius = float(r[np.argmin(np.abs(z - height))])
    distance, angle = 0.5 * radius * (1.0 + node), 2.0 * np.pi * np.arange(count) / count
    points = np.empty((len(node), count, 3))
    points[..., 0] = distance[:, None] * np.cos(angle)
    points[..., 1] = distance[:, None] * np.sin(angle)
    points[..., 2] = height
    size = np.repeat(np.pi * radius * distance * weight / count, count)
    return points.reshape(-1, 3), size
