"""Compiled substitutions with the blocks of a factor L D L^T: see ``cloth.factors.Factor``."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled


@compiled
def substitute(
    heads: Ints,
    row_starts: Ints,
    rows: Ints,
    value_starts: Ints,
    values: Array,
    pivots: Array,
    work: Array,
) -> None:
    """Overwrite ``work`` (n, k) with (L D L^T)^-1 work; see ``Factor``."""
    columns, blocks = work.shape[1], len(heads) - 1
    for s in range(blocks):
        head, width, q = heads[s], heads[s + 1] - heads[s], value_starts[s]
        for a in range(head + 1, head + width):
            for b in range(head, a):
                for c in range(columns):
                    work[a, c] -= values[q] * work[b, c]
                q += 1
        for r in range(row_starts[s], row_starts[s + 1]):
            i = rows[r]
            for b in range(head, head + width):
                for c in range(columns):
                    work[i, c] -= values[q] * work[b, c]
                q += 1
    for s in range(blocks - 1, -1, -1):
        head, width, q = heads[s], heads[s + 1] - heads[s], value_starts[s + 1]
        for b in range(head, head + width):
            for c in range(columns):
                work[b, c] /= pivots[b]
        for r in range(row_starts[s + 1] - 1, row_starts[s] - 1, -1):
            i = rows[r]
            for b in range(head + width - 1, head - 1, -1):
                q -= 1
                for c in range(columns):
                    work[b, c] -= values[q] * work[i, c]
        for a in range(head + width - 1, head, -1):
            for b in range(a - 1, head - 1, -1):
                q -= 1
                for c in range(columns):
                    work[b, c] -= values[q] * work[a, c]


@compiled
def _reduce(values: Array, q: int, head: int, width: int, work: Array, i: int) -> int:
    """Take ``values[q:q + width]`` times the rows from ``head`` off row ``i``; where they end."""
    x, y, z = work[i, 0], work[i, 1], work[i, 2]
    for b in range(head, head + width):
        g, q = values[q], q + 1
        x, y, z = x - g * work[b, 0], y - g * work[b, 1], z - g * work[b, 2]
    work[i, 0], work[i, 1], work[i, 2] = x, y, z
    return q


@compiled
def forwards(
    heads: Ints, row_starts: Ints, rows: Ints, value_starts: Ints, values: Array, work: Array
) -> None:
    """Overwrite ``work`` (n, 3) with L^-1 work; its three columns stay in registers.

    Two rows at a time, so that one sum need not wait for the other.
    """
    for s in range(len(heads) - 1):
        head, width, q = heads[s], heads[s + 1] - heads[s], value_starts[s]
        for a in range(head + 1, head + width):
            q = _reduce(values, q, head, a - head, work, a)
        first, last = row_starts[s], row_starts[s + 1]
        for r in range(first, last - 1, 2):
            i, j = rows[r], rows[r + 1]
            x, y, z = work[i, 0], work[i, 1], work[i, 2]
            u, v, w = work[j, 0], work[j, 1], work[j, 2]
            for b in range(head, head + width):
                g, h, q = values[q], values[q + width], q + 1
                x, y, z = x - g * work[b, 0], y - g * work[b, 1], z - g * work[b, 2]
                u, v, w = u - h * work[b, 0], v - h * work[b, 1], w - h * work[b, 2]
            q += width
            work[i, 0], work[i, 1], work[i, 2] = x, y, z
            work[j, 0], work[j, 1], work[j, 2] = u, v, w
        if (last - first) % 2 == 1:
            _reduce(values, q, head, width, work, rows[last - 1])


@compiled
def backwards(
    heads: Ints,
    row_starts: Ints,
    rows: Ints,
    value_starts: Ints,
    values: Array,
    pivots: Array,
    work: Array,
) -> None:
    """Overwrite ``work`` (n, 3) with (D L^T)^-1 work."""
    for s in range(len(heads) - 2, -1, -1):
        head, width, triangle = heads[s], heads[s + 1] - heads[s], value_starts[s]
        below = triangle + width * (width - 1) // 2
        for b in range(width - 1, -1, -1):
            scale, q = 1.0 / pivots[head + b], below + b
            x, y, z = (
                scale * work[head + b, 0],
                scale * work[head + b, 1],
                scale * work[head + b, 2],
            )
            for r in range(row_starts[s], row_starts[s + 1]):
                i, g, q = rows[r], values[q], q + width
                x, y, z = x - g * work[i, 0], y - g * work[i, 1], z - g * work[i, 2]
            for a in range(b + 1, width):
                i, g = head + a, values[triangle + a * (a - 1) // 2 + b]
                x, y, z = x - g * work[i, 0], y - g * work[i, 1], z - g * work[i, 2]
            work[head + b, 0], work[head + b, 1], work[head + b, 2] = x, y, z


@compiled
def solve_nodes(
    heads: Ints,
    row_starts: Ints,
    rows: Ints,
    value_starts: Ints,
    values: Array,
    pivots: Array,
    order: Ints,
    right: Array,
    result: Array,
) -> None:
    """See ``Factor.solve``."""
    work = np.empty((len(order), 3))
    for i in range(len(order)):
        for d in range(3):
            work[i, d] = right[order[i], d]
    forwards(heads, row_starts, rows, value_starts, values, work)
    backwards(heads, row_starts, rows, value_starts, values, pivots, work)
    for i in range(len(order)):
        for d in range(3):
            result[order[i], d] = work[i, d]
