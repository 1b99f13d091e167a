"""Boxes that overlap, found by a grid."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled

CELLS = 16  # at most, per box: bounds what is cleared and summed for every search


@compiled
def motion_boxes(start: Array, end: Array, triangles: Ints, margin: float) -> tuple[Array, Array]:
    """Return boxes around the straight motion of every triangle.

    Parameters
    ----------
    start, end
        Positions (n, 3) [m] at either end of the motion.
    triangles
        Nodes of each triangle (m, 3).
    margin
        Length [m] that is added on every side.

    Returns
    -------
    lower, upper : Array
        Corners of the boxes (m, 3) [m].
    """
    m = triangles.shape[0]
    lower, upper = np.empty((m, 3)), np.empty((m, 3))
    for t in range(m):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        for d in range(3):
            low = min(min(start[i, d], start[j, d]), start[k, d])
            high = max(max(start[i, d], start[j, d]), start[k, d])
            lower[t, d] = min(low, min(min(end[i, d], end[j, d]), end[k, d])) - margin
            upper[t, d] = max(high, max(max(end[i, d], end[j, d]), end[k, d])) + margin
    return lower, upper


@compiled
def _grid(lower: Array, upper: Array) -> tuple[Array, float, Ints]:
    """Origin (3,) [m], cell width [m] and cell counts (3,) of a grid around all boxes."""
    m = lower.shape[0]
    origin, top, width = lower[0].copy(), upper[0].copy(), 1e-12
    for a in range(m):
        for d in range(3):
            origin[d] = min(origin[d], lower[a, d])
            top[d] = max(top[d], upper[a, d])
            width = max(width, upper[a, d] - lower[a, d])
    width *= 1.000001
    shape = np.empty(3, dtype=np.int64)
    while True:
        cells = 1.0
        for d in range(3):
            cells *= np.floor((top[d] - origin[d]) / width) + 1.0
        if cells <= CELLS * m + 64:
            break
        width *= 1.25
    for d in range(3):
        shape[d] = np.int64((top[d] - origin[d]) / width) + 1
    return origin, width, shape


@compiled
def _by_cell(lower: Array, upper: Array) -> tuple[Ints, Ints, Ints, Ints]:
    """Boxes in the order of their cells: index (m,) and cell (m, 3); first of each cell; shape."""
    origin, width, shape = _grid(lower, upper)
    m = lower.shape[0]
    key, order = np.empty(m, dtype=np.int64), np.empty(m, dtype=np.int64)
    place, cell = np.empty(3, dtype=np.int64), np.empty((m, 3), dtype=np.int64)
    first = np.zeros(shape[0] * shape[1] * shape[2] + 1, dtype=np.int64)
    for a in range(m):
        for d in range(3):
            middle = 0.5 * (lower[a, d] + upper[a, d]) - origin[d]
            place[d] = min(np.int64(middle / width), shape[d] - 1)
        key[a] = (place[0] * shape[1] + place[1]) * shape[2] + place[2]
        first[key[a]] += 1
    for c in range(1, first.shape[0]):
        first[c] += first[c - 1]
    for a in range(m - 1, -1, -1):
        c = key[a]
        first[c] -= 1
        order[first[c]] = a
        cell[first[c], 0], cell[first[c], 1] = c // (shape[1] * shape[2]), c // shape[2] % shape[1]
        cell[first[c], 2] = c % shape[2]
    return order, cell, first, shape


@compiled
def near_boxes(lower: Array, upper: Array) -> Ints:
    """Return the pairs of boxes that overlap or touch, each once, in an order the grid gives.

    A grid of cells at least as wide as the widest box holds the boxes by their centres, so that
    only the 27 cells around one can hold its partners. Near-linear in m while boxes are of similar
    size, quadratic at worst.

    Parameters
    ----------
    lower, upper
        Corners of the boxes (m, 3) [m]; that they are finite is not checked.

    Returns
    -------
    Ints
        Pairs (k, 2) of boxes.
    """
    m = lower.shape[0]
    found, count = np.empty((16 * m + 16, 2), dtype=np.int64), 0
    if m == 0:
        return found[:0]
    order, cell, first, shape = _by_cell(lower, upper)
    low, high = lower[order], upper[order]
    for a in range(m):
        a0, a1, a2, b0, b1, b2 = low[a, 0], low[a, 1], low[a, 2], high[a, 0], high[a, 1], high[a, 2]
        back, front = max(cell[a, 2] - 1, 0), min(cell[a, 2] + 1, shape[2] - 1)
        for i in range(cell[a, 0], min(cell[a, 0] + 2, shape[0])):
            for j in range(max(cell[a, 1] - 1, 0), min(cell[a, 1] + 2, shape[1])):
                row = (i * shape[1] + j) * shape[2]
                for b in range(max(first[row + back], a + 1), first[row + front + 1]):
                    if low[b, 0] > b0 or high[b, 0] < a0 or low[b, 1] > b1:
                        continue
                    if high[b, 1] < a1 or low[b, 2] > b2 or high[b, 2] < a2:
                        continue
                    if count == found.shape[0]:
                        larger = np.empty((2 * count, 2), dtype=np.int64)
                        larger[:count] = found
                        found = larger
                    found[count, 0], found[count, 1] = order[a], order[b]
                    count += 1
    return found[:count]
