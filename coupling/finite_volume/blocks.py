"""The seven blocks of a cubed ball, and what of them lies in its lower half.

A cube of n^3 cells, slightly swollen, is wrapped in six blocks of n^2 m cells that reach to the
sphere. In every block the points are those of one map of the unit cube, whatever n and m: meshes of
different sizes are samples of the same map. It is continuous, with a kink on the cube's diagonals.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.ports import Array, Ints

# Corners of a hexahedron in OpenFOAM's order.
_CORNERS = np.array(
    [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
)
CUBE_SIZE = 0.4  # half the inner cube's edge over R, on its axes
CUBE_BULGE = 0.5  # 0: a cube, 1: a sphere; between them the cells at its edges stay open


@dataclass(frozen=True, kw_only=True)
class Blocks:
    """The lower half of a cubed ball of radius 1, and where its points and cells are in the blocks.

    ``points`` (P, 3); ``hexes`` (c, 8), corners in OpenFOAM's order. ``grids``: of each block the
    points at its nodes (i + 1, j + 1, k + 1); ``cells``: its cells (i, j, k). Both are -1 in the
    upper half.
    """

    points: Array
    hexes: Ints
    grids: tuple[Ints, ...]
    cells: tuple[Ints, ...]


def lower_blocks(n: int, m: int) -> Blocks:
    """Return the lower half of the cubed ball with a cube of n^3 cells in m layers; n is even."""
    points, grids = _merge(_grids(n, m))
    hexes = [_hexes(grid) for grid in grids]
    lower = [points[block].mean(axis=-2)[..., 2] < 0 for block in hexes]
    used = np.unique(np.concatenate([b[low] for b, low in zip(hexes, lower, strict=True)]))
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    cells, start = [], 0
    for low in lower:
        found = np.full(low.shape, -1)
        found[low] = start + np.arange(low.sum())
        start += low.sum()
        cells.append(found)
    return Blocks(
        points=points[used],
        hexes=np.concatenate([number[b[low]] for b, low in zip(hexes, lower, strict=True)]),
        grids=tuple(number[grid] for grid in grids),
        cells=tuple(cells),
    )


def _hexes(grid: Ints) -> Ints:
    """Corners (i, j, k, 8) of the cells between the points ``grid`` (i + 1, j + 1, k + 1)."""
    cells = np.stack(np.meshgrid(*(np.arange(k - 1) for k in grid.shape), indexing="ij"), -1)
    corner = cells[..., None, :] + _CORNERS
    return np.asarray(grid[corner[..., 0], corner[..., 1], corner[..., 2]])


def _grids(n: int, m: int) -> list[Array]:
    """Points (i + 1, j + 1, k + 1, 3) of the seven blocks."""
    s = np.linspace(-1.0, 1.0, n + 1)
    grids = [_bulge(np.stack(np.meshgrid(s, s, s, indexing="ij"), axis=-1))]
    layers = np.linspace(0.0, 1.0, m + 1)[:, None, None, None]
    for axis in range(3):
        for side in (-1.0, 1.0):
            u, v = np.meshgrid(s, s, indexing="ij")
            plane = np.empty((n + 1, n + 1, 3))
            first, second = (axis + 1) % 3, (axis + 2) % 3
            plane[..., axis] = side
            plane[..., first] = u if side > 0 else v
            plane[..., second] = v if side > 0 else u
            spherical = np.tan(plane * np.pi / 4)  # equiangular: even cells over the sphere
            spherical /= np.linalg.norm(spherical, axis=-1, keepdims=True)
            block = (1 - layers) * _bulge(plane) + layers * spherical
            grids.append(np.moveaxis(block, 0, 2))
    return grids


def _bulge(cube: Array) -> Array:
    """Cube [-1, 1]^3 swollen towards a sphere, scaled to CUBE_SIZE on its axes."""
    largest = np.abs(cube).max(axis=-1, keepdims=True)
    direction = np.tan(cube * np.pi / 4)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    sphere = direction / np.where(length > 0, length, 1.0) * largest
    return np.asarray(CUBE_SIZE * ((1 - CUBE_BULGE) * cube + CUBE_BULGE * sphere))


def _merge(grids: list[Array]) -> tuple[Array, list[Ints]]:
    """Points (P, 3) of all blocks, each once, and where those of every block are among them."""
    flat = np.concatenate([g.reshape(-1, 3) for g in grids])
    rounded = np.round(flat, 9) + 0.0
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    points = flat[first]
    points[np.abs(points[:, 2]) < 1e-9, 2] = 0.0
    ends = np.cumsum([grid[..., 0].size for grid in grids])
    parts = np.split(inverse.ravel(), ends[:-1])
    return points, [part.reshape(g.shape[:3]) for part, g in zip(parts, grids, strict=True)]
