"""The six blocks of the half ball's mesh: half a cube in the middle, wrapped in layers.

Half a cube of n x n x n/2 cells, swollen towards a sphere, lies against the disc; five blocks join
its faces to the sphere, each of as many layers. Cells may be graded towards the disc and the
sphere, geometrically: the ratio of neighbours is as even as it can be, and tends to 1 as n grows.

Below a long liquid the half ball is a long one: between the disc and its equator stands a cylinder
of radius 1, in which the half ball's uppermost layer of points goes straight up.

In every block the points are those of one map of the unit cube, at levels of the block's three
directions: meshes of different divisions are samples of the same map. It is continuous, with a kink
on the cube's diagonals.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupling.ports import Array, Ints

CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)  # of a hexahedron, in OpenFOAM's order
LAYERS = 0.65  # from the cube to the shell, over n
CUBE_SIZE = 0.4  # half the inner cube's edge over R, on its axes
CUBE_BULGE = 0.5  # 0: a cube, 1: a sphere; between them the cells at its edges stay open
QUARTER = 0.25 * math.pi  # arc over R of the five blocks' sides, from the bottom one's to the disc
# Of the cells' height below the disc of a long half ball, per R of depth, over that at the disc:
# waves fade over some R/2. In a pill of 2:1, 3 R deep, omega^2 of the lowest one errs by the
# inertia of 1,332 cells by 3.5 % with even cells, 1.4 with 1.25, 1.25 with 2, 1.2 with 3, 1.4 with
# 5; 2 R deep, by that of 1,068, by 1.33, 1.27, 1.29 and 1.39 with 1.25, 2, 3 and 5.
GROWTH = 2.0


def graded(count: int, first: float) -> Array:
    """Return levels from 0 to 1 whose last interval is of a given length, or less.

    Parameters
    ----------
    count
        Number of even intervals that they replace; the longest is about as long as one of those.
    first
        Length of the last interval, that at the wall; 0, or more than 1/``count``, for even ones.

    Returns
    -------
    Array
        Levels (k + 1,), rising, with k at least ``count``; lengths are in a geometric progression.
    """
    if not 0.0 < first < 1.0 / count or count < 2:
        return np.linspace(0.0, 1.0, count + 1)
    from scipy.optimize import brentq  # slow to import, and even cells do without

    ratio = (1.0 - first) * count / (count - 1.0)  # of a progression from first to 1/count
    number = 1 + math.ceil(math.log(1.0 / (count * first)) / math.log(ratio))
    powers = np.arange(number)
    ratio = float(brentq(lambda r: first * np.sum(r**powers) - 1.0, 1.0, 2.0 * ratio))
    levels = 1.0 - first * np.append(0.0, np.cumsum(ratio**powers))[::-1]
    levels[0] = 0.0
    return np.asarray(levels)


def _halved(levels: Array, least: int) -> Array:
    """Levels of half as many intervals, rounded up, between the same ends; ``least`` of them."""
    count = len(levels) - 1
    places = np.linspace(0.0, count, max(least, (count + 1) // 2) + 1)
    return np.asarray(np.interp(places, np.arange(count + 1), levels))


def depth_cells(n: int, length: float) -> int:
    """Cells from the cube's bottom to the disc of a half ball ``length`` R longer than a ball's.

    As many as would be as long, were they even, as the n/2 cells of a ball's.
    """
    return round(0.5 * n * (1.0 + length / QUARTER))


def _deep(count: int, spacing: float, length: float) -> Array:
    """Levels (k + 1,) from -1 to 0, the disc, of a long half ball's depth, in shares of its side.

    Heights grow with depth, by ``GROWTH``; where that leaves the cells at the disc higher than
    ``spacing`` radii they are graded towards it as a ball's.
    """
    side = QUARTER + length
    growth = 1.0 + GROWTH * side
    levels = (growth ** np.linspace(1.0, 0.0, count + 1) - 1.0) / (1.0 - growth)
    if 0.0 < spacing / side < -levels[-2]:
        return np.asarray(graded(count, spacing / side) - 1.0)
    return np.asarray(levels)


@dataclass(frozen=True, kw_only=True)
class Divisions:
    """How the blocks are divided.

    ``side`` (n + 1,): across the cube, from -1 to 1; ``depth`` (k + 1,): from its bottom, -1, to
    the disc, 0; ``layers`` (m + 1,): from the cube, 0, to the shell, 1. ``length``: of the
    cylinder on the half ball, over R, 0 for none.
    """

    side: Array
    depth: Array
    layers: Array
    length: float = 0.0

    @classmethod
    def of(cls, n: int, spacing: float, length: float = 0.0, depth: int = 0) -> Divisions:
        """Of n cells across the cube, n even, those at the walls at most ``spacing`` radii high.

        ``depth``: cells from a long one's bottom to the disc, 0 for ``depth_cells``.
        """
        # The highest cells below the disc are those at its rim, of a quarter turn's half.
        levels = graded(n // 2, spacing / QUARTER) - 1.0
        if length > 0.0:
            levels = _deep(depth or depth_cells(n, length), spacing, length)
        return cls(
            side=np.linspace(-1.0, 1.0, n + 1),
            depth=levels,
            layers=graded(round(LAYERS * n), spacing / (1.0 - CUBE_SIZE)),
            length=length,
        )

    def halved(self) -> Divisions:
        """With half as many cells in every direction, graded likewise."""
        return Divisions(
            side=_halved(self.side, 2),
            depth=_halved(self.depth, 1),
            layers=_halved(self.layers, 1),
            length=self.length,
        )

    def holds(self, other: Divisions) -> bool:
        """Whether there are as many cells as in ``other``, as long, in every direction, or more."""
        pairs = ((self.side, other.side), (self.depth, other.depth), (self.layers, other.layers))
        as_long = self.length == other.length
        return as_long and all(len(own) >= len(its) for own, its in pairs)

    @property
    def cells(self) -> int:
        """Number of cells of all blocks."""
        n, k, m = (len(levels) - 1 for levels in (self.side, self.depth, self.layers))
        return n * n * k + 4 * n * k * m + n * n * m

    @property
    def top(self) -> int:
        """Number of faces on the disc."""
        n, m = len(self.side) - 1, len(self.layers) - 1
        return n * n + 4 * n * m


@dataclass(frozen=True, kw_only=True)
class Block:
    """One of the blocks, of i x j x k cells, in the numbering of the whole mesh.

    ``levels``: of its three directions; ``points`` (i + 1, j + 1, k + 1); ``cells`` (i, j, k).
    """

    levels: tuple[Array, Array, Array]
    points: Ints
    cells: Ints


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """``points`` (P, 3) of all blocks, over R; ``hexes`` (c, 8), corners in OpenFOAM's order."""

    points: Array
    hexes: Ints
    blocks: tuple[Block, ...]


def half_blocks(divisions: Divisions) -> Blocks:
    """Return the blocks of the half ball of radius 1, the points that they share merged."""
    own = divisions.side, divisions.side, divisions.depth
    levels = [own]
    depth, height = _in_ball(divisions)
    along = divisions.side, divisions.side, depth
    heights = np.zeros(len(divisions.side)), np.zeros(len(divisions.side)), height
    grids = [_bulge(np.stack(np.meshgrid(*along, indexing="ij"), axis=-1))]
    grids[0][..., 2] += height
    layers = divisions.layers[:, None, None, None]
    for axis, side in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0), (2, -1.0)):
        first, second = (axis + 1) % 3, (axis + 2) % 3
        if side < 0:
            first, second = second, first
        u, v = np.meshgrid(along[first], along[second], indexing="ij")
        plane = np.empty((*u.shape, 3))
        plane[..., axis], plane[..., first], plane[..., second] = side, u, v
        spherical = np.tan(plane * np.pi / 4)  # equiangular: even cells over the sphere
        spherical /= np.linalg.norm(spherical, axis=-1, keepdims=True)
        block = (1 - layers) * _bulge(plane) + layers * spherical
        bottom = height[0] if axis == 2 else 0.0
        block[..., 2] += bottom + heights[first][:, None] + heights[second]
        grids.append(np.moveaxis(block, 0, 2))
        levels.append((own[first], own[second], divisions.layers))
    return _merged(grids, levels)


def _in_ball(divisions: Divisions) -> tuple[Array, Array]:
    """Depths (k + 1,) in the half ball, and what the points there are raised by (k + 1,), over R.

    The disc stays at the height 0, and what lies in the cylinder is raised from the ball's equator.
    """
    depth, length = divisions.depth, divisions.length
    if length == 0.0:
        return depth, np.zeros(len(depth))
    arc = (1.0 + depth) * (QUARTER + length)
    return np.minimum(arc / QUARTER, 1.0) - 1.0, np.maximum(arc - QUARTER, 0.0) - length


def _bulge(cube: Array) -> Array:
    """Cube [-1, 1]^3 swollen towards a sphere, scaled to CUBE_SIZE on its axes."""
    largest = np.abs(cube).max(axis=-1, keepdims=True)
    direction = np.tan(cube * np.pi / 4)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    sphere = direction / np.where(length > 0, length, 1.0) * largest
    return np.asarray(CUBE_SIZE * ((1 - CUBE_BULGE) * cube + CUBE_BULGE * sphere))


def _merged(grids: list[Array], levels: list[tuple[Array, Array, Array]]) -> Blocks:
    """Blocks whose points (i + 1, j + 1, k + 1, 3) are ``grids``, what they share made one."""
    flat = np.concatenate([g.reshape(-1, 3) for g in grids])
    rounded = np.round(flat, 9) + 0.0
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    points, inverse = flat[first], inverse.ravel()
    points[np.abs(points[:, 2]) < 1e-9, 2] = 0.0
    hexes, blocks, start, count = [], [], 0, 0
    for grid, along in zip(grids, levels, strict=True):
        shape = np.array(grid.shape[:3])
        ids = inverse[start : start + shape.prod()].reshape(shape)
        start += shape.prod()
        cells = np.stack(np.meshgrid(*(np.arange(k) for k in shape - 1), indexing="ij"), -1)
        corner = cells.reshape(-1, 1, 3) + CORNERS
        hexes.append(ids[corner[..., 0], corner[..., 1], corner[..., 2]])
        number = count + np.arange((shape - 1).prod()).reshape(shape - 1)
        count += number.size
        blocks.append(Block(levels=along, points=ids, cells=number))
    return Blocks(points=points, hexes=np.concatenate(hexes), blocks=tuple(blocks))
