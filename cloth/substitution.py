"""Compiled substitutions with the blocks of a factor L D L^T: see ``cloth.factors.Factor``."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.vector_rows import subtract_products


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
    """Overwrite ``work`` with (L D L^T)^-1 work, for any number of columns.

    Parameters
    ----------
    heads, row_starts, rows, value_starts, values, pivots
        The blocks of L and the diagonal of D, as ``cloth.factors.Factor`` describes them.
    work
        Right-hand sides (n, k), the nodes in the factor's order; becomes the solutions.
    """
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
def forwards(
    heads: Ints, row_starts: Ints, rows: Ints, value_starts: Ints, values: Array, work: Array
) -> None:
    """Overwrite ``work`` with L^-1 work, four rows at a time.

    Parameters
    ----------
    heads, row_starts, rows, value_starts, values
        The blocks of L, as ``cloth.factors.Factor`` describes them.
    work
        Right-hand sides (n, 4), the nodes in the factor's order; becomes the result.
    """
    every = np.arange(len(work))
    for s in range(len(heads) - 1):
        head, width, q = heads[s], heads[s + 1] - heads[s], value_starts[s]
        for a in range(1, width):
            subtract_products(work, (head + a,), every[head : head + a], values, q, (0, 1))
            q += a
        block, r, last = every[head : head + width], row_starts[s], row_starts[s + 1]
        while r + 4 <= last:
            targets = (rows[r], rows[r + 1], rows[r + 2], rows[r + 3])
            subtract_products(work, targets, block, values, q, (width, 1))
            q += 4 * width
            r += 4
        while r < last:
            subtract_products(work, (rows[r],), block, values, q, (0, 1))
            q += width
            r += 1


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
    """Overwrite ``work`` with (D L^T)^-1 work, four columns of L at a time.

    Parameters
    ----------
    heads, row_starts, rows, value_starts, values, pivots
        The blocks of L and the diagonal of D, as ``cloth.factors.Factor`` describes them.
    work
        What ``forwards`` leaves (n, 4); becomes the solution.
    """
    every = np.arange(len(work))
    for s in range(len(heads) - 2, -1, -1):
        head, width, triangle = heads[s], heads[s + 1] - heads[s], value_starts[s]
        q, below = triangle + width * (width - 1) // 2, rows[row_starts[s] : row_starts[s + 1]]
        for b in range(head, head + width):
            scale = 1.0 / pivots[b]
            for d in range(4):
                work[b, d] *= scale
        b = 0
        while b + 4 <= width:
            c = head + b
            subtract_products(work, (c, c + 1, c + 2, c + 3), below, values, q + b, (1, width))
            b += 4
        while b < width:
            subtract_products(work, (head + b,), below, values, q + b, (0, width))
            b += 1
        for a in range(width - 1, 0, -1):
            row, q = every[head + a : head + a + 1], triangle + a * (a - 1) // 2
            b = 0
            while b + 4 <= a:
                c = head + b
                subtract_products(work, (c, c + 1, c + 2, c + 3), row, values, q + b, (1, 0))
                b += 4
            while b < a:
                subtract_products(work, (head + b,), row, values, q + b, (0, 0))
                b += 1


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
    """Solve L D L^T x = b for the nodes' three components at once, as ``Factor.solve`` does.

    A fourth component of zeros fills the vectors that the loops work with.

    Parameters
    ----------
    heads, row_starts, rows, value_starts, values, pivots
        The blocks of L and the diagonal of D, as ``cloth.factors.Factor`` describes them.
    order
        Node of each row of the factor (n,).
    right
        Right-hand side (m, 3), of which the rows in ``order`` are read.
    result
        Solution (m, 3); its rows in ``order`` are filled, the others stay.
    """
    work = np.empty((len(order), 4))
    for i in range(len(order)):
        for d in range(3):
            work[i, d] = right[order[i], d]
        work[i, 3] = 0.0
    forwards(heads, row_starts, rows, value_starts, values, work)
    backwards(heads, row_starts, rows, value_starts, values, pivots, work)
    for i in range(len(order)):
        for d in range(3):
            result[order[i], d] = work[i, d]
