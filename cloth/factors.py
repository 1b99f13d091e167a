"""Compiled triangular solves with a sparse L D L^T factor in dense blocks.

Neighbouring columns of L with the same rows below them form a supernode (Ashcraft and Grimes
1989), kept as one dense block: half the memory to read, and each row of the right-hand side is
visited once a block instead of once a column.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.substitution import solve_nodes, substitute

WIDEST = 64  # columns of a block


@dataclass(frozen=True, kw_only=True)
class Factor:
    """The factors of a matrix L D L^T: L, unit lower triangular, and D = ``pivots`` (n,).

    Block s holds columns ``heads[s]`` to ``heads[s + 1]`` and, below its own triangle, the rows
    ``rows[row_starts[s]:row_starts[s + 1]]``. ``values`` from ``value_starts[s]``: the strict lower
    triangle row by row, then the rows below.
    """

    heads: Ints
    row_starts: Ints
    rows: Ints
    value_starts: Ints
    values: Array
    pivots: Array

    def solve(self, right: Array, order: Ints, result: Array) -> None:
        """Solve with the matrix on the nodes in ``order``, for three components at once.

        Parameters
        ----------
        right
            Right-hand side (m, 3), of which the rows in ``order`` are read.
        order
            Node of each of the factor's rows (n,).
        result
            ``result[order]`` becomes (L D L^T)^-1 ``right[order]``; the other rows of (m, 3) stay.
        """
        solve_nodes(
            self.heads, self.row_starts, self.rows, self.value_starts, self.values, self.pivots,
            order, right, result,
        )  # fmt: skip

    def solved(self, right: Array, block: int = 48) -> Array:
        """Return (L D L^T)^-1 ``right`` (n, k), in blocks of columns that stay in the cache."""
        result = np.empty_like(right)
        for c in range(0, right.shape[1], block):
            part = right[:, c : c + block].copy()
            substitute(
                self.heads, self.row_starts, self.rows, self.value_starts, self.values,
                self.pivots, part,
            )  # fmt: skip
            result[:, c : c + block] = part
        return result


def factor_of(starts: Ints, rows: Ints, values: Array, pivots: Array) -> Factor:
    """Return the factor with L in dense blocks, from its columns.

    Parameters
    ----------
    starts, rows, values
        L by columns, without its diagonal: column j holds ``values[starts[j]:starts[j + 1]]`` in
        ``rows``, which must be sorted in each column; ``starts`` (n + 1,).
    pivots
        D (n,).
    """
    heads, row_starts, value_starts = _group(starts, rows)
    below = np.empty(row_starts[-1], dtype=np.int64)
    blocks = np.empty(value_starts[-1])
    _fill(starts, rows, values, heads, row_starts, value_starts, below, blocks)
    return Factor(
        heads=heads,
        row_starts=row_starts,
        rows=below,
        value_starts=value_starts,
        values=blocks,
        pivots=np.ascontiguousarray(pivots),
    )


@compiled
def _group(starts: Ints, rows: Ints) -> tuple[Ints, Ints, Ints]:
    """Heads, first rows and first values of the blocks, each with one entry more than blocks."""
    n = len(starts) - 1
    found = np.zeros((3, n + 1), dtype=np.int64)
    s, j = 0, 0
    while j < n:
        k = j
        while (
            k + 1 < n
            and k - j + 1 < WIDEST
            and starts[k + 2] - starts[k + 1] == starts[k + 1] - starts[k] - 1
            and rows[starts[k]] == k + 1
        ):
            k += 1
        width, below = k - j + 1, starts[k + 1] - starts[k]
        s, j = s + 1, k + 1
        found[0, s] = j
        found[1, s] = found[1, s - 1] + below
        found[2, s] = found[2, s - 1] + width * (width - 1) // 2 + width * below
    return found[0, : s + 1].copy(), found[1, : s + 1].copy(), found[2, : s + 1].copy()


@compiled
def _fill(
    starts: Ints,
    rows: Ints,
    values: Array,
    heads: Ints,
    row_starts: Ints,
    value_starts: Ints,
    below: Ints,
    blocks: Array,
) -> None:
    """Copy the columns into their blocks."""
    for s in range(len(heads) - 1):
        head, width = heads[s], heads[s + 1] - heads[s]
        count, triangle = row_starts[s + 1] - row_starts[s], width * (width - 1) // 2
        last = starts[head + width - 1]
        for r in range(count):
            below[row_starts[s] + r] = rows[last + r]
        for b in range(width):
            first = starts[head + b]
            for a in range(b + 1, width):
                blocks[value_starts[s] + a * (a - 1) // 2 + b] = values[first + a - b - 1]
            for r in range(count):
                place = value_starts[s] + triangle + r * width + b
                blocks[place] = values[first + width - 1 - b + r]
