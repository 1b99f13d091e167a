"""Compiled triangular solves with a sparse L D L^T factor, and its low-rank update."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled


@compiled
def substitute(starts: Ints, rows: Ints, values: Array, pivots: Array, work: Array) -> None:
    """Overwrite ``work`` (n, k) with (L D L^T)^-1 work; L unit lower by columns, no diagonal.

    ``starts`` (n + 1,), ``rows``, ``values``: the columns of L; ``pivots`` (n,): D.
    """
    n, width = work.shape
    for j in range(n):
        for p in range(starts[j], starts[j + 1]):
            i, value = rows[p], values[p]
            for c in range(width):
                work[i, c] -= value * work[j, c]
    for j in range(n - 1, -1, -1):
        scale = 1.0 / pivots[j]
        for c in range(width):
            work[j, c] *= scale
        for p in range(starts[j], starts[j + 1]):
            i, value = rows[p], values[p]
            for c in range(width):
                work[j, c] -= value * work[i, c]


@compiled
def substitute_vectors(starts: Ints, rows: Ints, values: Array, pivots: Array, work: Array) -> None:
    """``substitute`` for ``work`` (n, 3), half as long: its three columns stay in registers."""
    n = work.shape[0]
    for j in range(n):
        a, b, c = work[j, 0], work[j, 1], work[j, 2]
        for p in range(starts[j], starts[j + 1]):
            i, value = rows[p], values[p]
            work[i, 0] -= value * a
            work[i, 1] -= value * b
            work[i, 2] -= value * c
    for j in range(n - 1, -1, -1):
        scale = 1.0 / pivots[j]
        a, b, c = scale * work[j, 0], scale * work[j, 1], scale * work[j, 2]
        for p in range(starts[j], starts[j + 1]):
            i, value = rows[p], values[p]
            a -= value * work[i, 0]
            b -= value * work[i, 1]
            c -= value * work[i, 2]
        work[j, 0], work[j, 1], work[j, 2] = a, b, c


@compiled
def low_rank_step(directions: Array, right: Array, solved: Array) -> None:
    """solved -= Z^T Z right in one pass over Z = ``directions`` (r, N)."""
    size = directions.shape[1]
    for r in range(directions.shape[0]):
        z = directions[r]
        p = 0.0
        for i in range(size):
            p += z[i] * right[i]
        for i in range(size):
            solved[i] -= p * z[i]


def substitute_blocked(
    starts: Ints, rows: Ints, values: Array, pivots: Array, work: Array, block: int = 48
) -> Array:
    """(L D L^T)^-1 work (n, k) in blocks of columns that stay in the cache."""
    result = np.empty_like(work)
    for c in range(0, work.shape[1], block):
        part = work[:, c : c + block].copy()
        substitute(starts, rows, values, pivots, part)
        result[:, c : c + block] = part
    return result
