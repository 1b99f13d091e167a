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
def low_rank_step(directions: Array, first: Array, second: Array, a: Array, b: Array) -> None:
    """a -= Z^T Z first and b -= Z^T Z second, in one pass over Z = ``directions`` (r, N)."""
    size = directions.shape[1]
    for r in range(directions.shape[0]):
        z = directions[r]
        p, q = 0.0, 0.0
        for i in range(size):
            p += z[i] * first[i]
            q += z[i] * second[i]
        for i in range(size):
            a[i] -= p * z[i]
            b[i] -= q * z[i]


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
