"""Flat meshes: a disc, two discs joined along the rim, a strip.

Sheets cut from flat film, for the shapes whose exact answers are known: all lie in z = 0. Gas is
on the side of z > 0, or outside of a closed sheet.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.mesh import Mesh

GAP: Final = 1e-6  # of the radius: two discs on each other have no normal at their rim


def _polar(radius: float, rings: int, sectors: int) -> tuple[Array, Ints]:
    """Points (1 + rings sectors, 3) [m], ring by ring from the centre, and triangles of a disc.

    All quadrilaterals are cut the same way, so that turning by a sector maps the mesh on itself.
    """
    if rings < 2:
        raise ValueError(f"cloth.resolution: needs at least 2 rings, got {rings}.")
    if sectors < 3:
        raise ValueError(f"disc: needs at least 3 sectors, got {sectors}.")
    if not radius > 0.0:
        raise ValueError(f"disc: radius must be positive, got {radius}.")
    angle = 2.0 * np.pi * np.arange(sectors) / sectors
    distance = radius * np.arange(1, rings + 1) / rings
    plan = distance[:, None, None] * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    here = 1 + np.arange(sectors)
    following = 1 + (np.arange(sectors) + 1) % sectors
    triangles = [np.column_stack([np.zeros_like(here), here, following])]
    for k in range(rings - 1):
        inner, outer = k * sectors, (k + 1) * sectors
        triangles.append(np.column_stack([inner + here, outer + here, outer + following]))
        triangles.append(np.column_stack([inner + here, outer + following, inner + following]))
    points = np.concatenate([np.zeros((1, 3)), plan.reshape(-1, 3)])
    return points, np.concatenate(triangles).astype(np.int64)


def disc(radius: float, rings: int, sectors: int) -> Mesh:
    """Return a disc of ``radius`` [m] with a fixed rim: its centre, then rings of nodes round it.

    There are ``rings`` of ``sectors`` nodes each. Edges run along the rays, and all nodes but the
    centre are alike. A disc that wrinkles carries its tension along the rays; in a mesh of
    half-turned rings, triangles on a chord shorten the rays by the chord's sagitta, which is of
    first order in the grid, here of second. The price is slender triangles near the centre: edges
    along and across a ray are equal at a distance of ``sectors``/(2 pi rings) of the radius. The
    area falls short of the circle's by (2 pi/sectors)^2/6. Raises ValueError for a number or a size
    that makes no disc.
    """
    points, triangles = _polar(radius, rings, sectors)
    return Mesh(
        points=points,
        triangles=triangles,
        fixed=np.arange(len(points)) > (rings - 1) * sectors,
        rim_distance=_to_rim(points, radius),
    )


def disc_pair(radius: float, rings: int, sectors: int) -> Mesh:
    """Return two discs of ``radius`` [m] on each other, joined along the rim: closed and free.

    The upper disc's nodes come first, as those of ``disc``; then the lower disc's, without the
    rim. Each bulges by a millionth of the radius, so that triangles point outward and the rim has
    a normal. No node is fixed: inertia alone holds the rigid motions. ``rim_distance`` as of a
    single disc.
    """
    points, upper = _polar(radius, rings, sectors)
    inside = len(points) - sectors
    points[:inside, 2] = GAP * (radius - np.sum(points[:inside] ** 2, axis=1) / radius)
    lower = np.where(upper < inside, upper + len(points), upper)[:, ::-1]
    both = np.concatenate([points, points[:inside] * [1.0, 1.0, -1.0]])
    free: Bools = np.zeros(len(both), dtype=np.bool_)
    return Mesh(
        points=both,
        triangles=np.ascontiguousarray(np.concatenate([upper, lower])),
        fixed=free,
        rim_distance=_to_rim(both, radius),
    )


def _to_rim(points: Array, radius: float) -> Array:
    return np.asarray(radius - np.linalg.norm(points, axis=1))


def strip(length: float, width: float, segments: int) -> Mesh:
    """Return a strip 0 <= x <= ``length``, |y| <= ``width``/2 [m], its ends fixed, its edges free.

    An even number of rows, at least two, as near to equilateral as the width allows: the strip is
    its own mirror image in y = 0. Nodes lie on lines of constant y, on the long edges at
    ``segments`` equal steps, on every second line shifted by half a step and closed by half
    steps at the ends. ``rim_distance``: to the nearer end. Raises ValueError for fewer than two
    segments or a size that is not positive.
    """
    if segments < 2:
        raise ValueError(f"cloth.resolution: needs at least 2 segments, got {segments}.")
    if not min(length, width) > 0.0:
        raise ValueError(f"strip: length and width must be positive, got {length} and {width}.")
    step = length / segments
    rows = 2 * max(1, round(width / (math.sqrt(3.0) * step)))
    even = np.linspace(0.0, length, segments + 1)
    odd = np.concatenate([[0.0], 0.5 * (even[1:] + even[:-1]), [length]])
    points, triangles, start = [], [], 0
    for row in range(rows + 1):
        x = odd if row % 2 else even
        y = np.full(len(x), width * (row / rows - 0.5))
        points.append(np.column_stack([x, y, 0.0 * x]))
        if row < rows:
            triangles += _row(start, start + len(x), segments, even_below=row % 2 == 0)
        start += len(x)
    positions = np.concatenate(points)
    return Mesh(
        points=positions,
        triangles=np.array(triangles, dtype=np.int64),
        fixed=(positions[:, 0] == 0.0) | (positions[:, 0] == length),
        rim_distance=np.minimum(positions[:, 0], length - positions[:, 0]),
    )


def _row(below: int, above: int, segments: int, *, even_below: bool) -> list[tuple[int, int, int]]:
    """Triangles between two lines of nodes, whose first nodes are ``below`` and ``above``."""
    even, odd = (below, above) if even_below else (above, below)
    found = [(even + j, odd + j + 1, odd + j) for j in range(segments + 1)]
    found += [(even + j, even + j + 1, odd + j + 1) for j in range(segments)]
    return found if even_below else [(a, c, b) for a, b, c in found]
