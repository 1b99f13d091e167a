"""Quadrilaterals on a disc: a square in the middle, wrapped in rings."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints

SQUARE_SIZE = 0.4  # half the inner square's edge over the radius, on its axes
SQUARE_BULGE = 0.5  # 0: a square, 1: a circle
_COARSEST = 12  # n = 2


def disc_grid(faces: int) -> tuple[Array, Ints]:
    """Return the finest grid of at most ``faces`` quadrilaterals on the unit disc.

    Points (p, 2), quadrilaterals (F, 4), counter-clockwise. n cells along the square's edge, n
    even, and 0.65 n rings. The rim's polygon has the area of the disc. ``ValueError`` where
    ``faces`` is less than those of the coarsest grid.
    """
    if faces < _COARSEST:
        raise ValueError(f"the coarsest disc has {_COARSEST} faces, got {faces}")
    n = 2
    while (n + 2) ** 2 + 4 * (n + 2) * round(0.65 * (n + 2)) <= faces:
        n += 2
    m = round(0.65 * n)
    side = np.linspace(-1.0, 1.0, n + 1)
    blocks = [_bulge(np.stack(np.meshgrid(side, side, indexing="ij"), axis=-1))]
    layer = np.linspace(0.0, 1.0, m + 1)[:, None, None]
    angle, step = side * np.pi / 4, np.pi / (2 * n)
    arc = np.sqrt(step / np.sin(step)) * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    edge = np.stack([np.ones_like(side), side], axis=-1)
    for quarter in range(4):
        cos, sin = ((1, 0, -1, 0)[quarter], (0, 1, 0, -1)[quarter])
        turn = np.array([(cos, sin), (-sin, cos)])
        blocks.append(((1 - layer) * _bulge(edge) + layer * arc) @ turn)
    return _merge(blocks)


def _bulge(square: Array) -> Array:
    """Square [-1, 1]^2 swollen towards a circle, scaled to ``SQUARE_SIZE`` on its axes."""
    largest = np.abs(square).max(axis=-1, keepdims=True)
    direction = np.tan(square * np.pi / 4)
    length = np.linalg.norm(direction, axis=-1, keepdims=True)
    circle = direction / np.where(length > 0, length, 1.0) * largest
    return np.asarray(SQUARE_SIZE * ((1 - SQUARE_BULGE) * square + SQUARE_BULGE * circle))


def _merge(blocks: list[Array]) -> tuple[Array, Ints]:
    """Points shared between the blocks made one."""
    flat = np.concatenate([block.reshape(-1, 2) for block in blocks])
    _, first, inverse = np.unique(
        np.round(flat, 9) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    faces, start = [], 0
    for block in blocks:
        ids = inverse.ravel()[start : start + block.shape[0] * block.shape[1]]
        ids = ids.reshape(block.shape[:2])
        start += ids.size
        corner = (ids[:-1, :-1], ids[1:, :-1], ids[1:, 1:], ids[:-1, 1:])
        faces.append(np.stack(corner, axis=-1).reshape(-1, 4))
    return flat[first], np.concatenate(faces)
