"""The thesis' square grid on the moulded hemisphere (its section 4.2.1 and appendix B)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Bools, Ints

SIZE = 26  # nodes across in the thesis' Table 5, 676 in all
_LIMIT = np.pi / 2.01  # of the gnomonic angles: tan stays finite, the rim stays below the equator
_TURNS = ((0, -1), (1, 0), (0, 1), (-1, 0))


@dataclass(frozen=True, kw_only=True)
class ThesisGrid:
    """``size`` x ``size`` nodes in rows, and the triangles that carry them into the results.

    ``points`` (size^2, 3) [m] of the moulded shape, row by row; ``triangles`` (2 (size - 1)^2, 3),
    counter-clockwise seen from the gas, two to a cell, divided as appendix D divides it for its
    area; ``fixed`` (size^2,), the nodes of the outer square.
    """

    size: int
    points: Array
    triangles: Ints
    fixed: Bools


def thesis_grid(radius: float, size: int = SIZE, *, repaired: bool = True) -> ThesisGrid:
    """Return the thesis' grid on the hemisphere z <= 0 of ``radius`` [m].

    There the sheet of an empty tank lies; the liquid everts it.

    A gnomonic grid of one face of a cube, its lines drawn on over the half sphere, then turned
    about z arm by arm so that every arm's nodes lie at even angles. The listing's ``i = i + 1``
    after ``i = round(GridSize / 2)``, where a line is lost, is read as "j is one more than i":
    no other start keeps the spiral within the grid.

    Erratum 10. Kept: the thesis calls the arms rings, but they are turns of one spiral, of
    8 k - 2 nodes and not 8 k - 4, so that the grid has no symmetry at all. Kept: odd sizes have no
    middle to start from; they are refused here (ValueError), where the listing runs out of bounds.
    Repaired: the rim lies 0.0055 to 0.0078 radii below the equator, by which the liquid's volume
    would err by 0.4 % of the tank's; its nodes are moved to the equator. ``repaired=False``
    leaves them.
    """
    if size < 4 or size % 2:
        raise ValueError(
            f"cloth.resolution: the thesis' grid needs an even number of nodes across, at least 4, "
            f"got {size}."
        )
    points = _gnomonic(size)
    _even_out(points, _spiral(size))
    edge = np.zeros((size, size), dtype=bool)
    edge[[0, -1], :] = True
    edge[:, [0, -1]] = True
    if repaired:
        points[edge, 2] = 0.0
        points[edge] /= np.linalg.norm(points[edge], axis=1)[:, None]
    return ThesisGrid(
        size=size,
        points=radius * points.reshape(-1, 3),
        triangles=_triangles(size),
        fixed=edge.ravel(),
    )


def _gnomonic(size: int) -> Array:
    """Unit vectors (size, size, 3) through a plane grid of even angles; rows run along y."""
    tangent = np.tan(np.linspace(-_LIMIT, _LIMIT, size))
    y, x = np.meshgrid(tangent, tangent, indexing="ij")
    points = np.stack([x, y, -np.ones_like(x)], axis=-1)
    return np.asarray(points / np.linalg.norm(points, axis=-1, keepdims=True))


def _spiral(size: int) -> Ints:
    """Rows and columns (size^2, 2) of the nodes from the middle outwards, clockwise."""
    i, j = size // 2 - 1, size // 2
    path = [(i, j)]
    turn = 0
    while len(path) < size**2:
        di, dj = _TURNS[turn % 4]
        for _ in range(min(turn // 2 + 1, size - 1)):
            i, j = i + di, j + dj
            path.append((i, j))
        turn += 1
    return np.array(path, dtype=np.int64)


def _even_out(points: Array, path: Ints) -> None:
    """Turn the nodes of every arm about z towards even angles; changes ``points``.

    Fully at the rim, not at all at the pole: by the share 1 - |z| of the way. The last arm has
    three sides of the outer square only; the thesis spreads it over 270 degrees, fully.
    """
    size = len(points)
    i, j = path.T
    angle = np.degrees(np.arctan2(points[i, j, 1], points[i, j, 0])) % 360.0
    turned = np.empty_like(angle)
    start = 0
    for arm in range(1, size // 2):
        here = slice(start, start + 8 * arm - 2)
        count = 8 * arm - 2
        even = 360.0 - 360.0 / count * np.arange(count)
        wrap = int(np.flatnonzero(np.diff(angle[here]) > 0.0)[-1]) + 1
        share = 1.0 + points[i[here], j[here], 2]
        turned[here] = share * (np.roll(even, wrap) - angle[here])
        start += count
    count = len(path) - start
    turned[start:] = 315.0 - 270.0 / count * np.arange(count) - angle[start:]
    c, s = np.cos(np.radians(turned)), np.sin(np.radians(turned))
    x, y = points[i, j, 0], points[i, j, 1]
    points[i, j, 0], points[i, j, 1] = c * x - s * y, s * x + c * y


def _triangles(size: int) -> Ints:
    """Two triangles to a cell, divided by the diagonal that appendix D takes."""
    number = np.arange(size**2, dtype=np.int64).reshape(size, size)
    a, b, c, d = number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]
    halves = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=-2)
    return np.asarray(halves.reshape(-1, 3))


def node_areas(x: Array) -> Array:
    """Return a quarter of the four cells round each inner node (size, size) [m^2], 0 at the rim.

    ``x`` (size, size, 3) [m]. A cell is the sum of the triangles on either side of its diagonal
    (appendix D).
    """
    a, b, c = x[:-1, 1:] - x[:-1, :-1], x[1:, :-1] - x[:-1, :-1], x[1:, 1:] - x[:-1, :-1]
    cells = np.linalg.norm(np.cross(a, c), axis=-1) + np.linalg.norm(np.cross(b, c), axis=-1)
    areas = np.zeros(x.shape[:2])
    areas[1:-1, 1:-1] = (cells[:-1, :-1] + cells[1:, :-1] + cells[:-1, 1:] + cells[1:, 1:]) / 8.0
    return areas
