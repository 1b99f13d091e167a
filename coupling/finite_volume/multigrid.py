"""Approximate inverse of a mesh's Laplacian by multigrid, in time that grows as the points do."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu

from cloth.compiled import compiled
from coupling.finite_volume.laplacian import SYMMETRIC
from coupling.ports import Array


class Multigrid:
    """V-cycle for a symmetric positive definite ``matrix`` (n, n).

    ``prolongations``: interpolations (n_l, n_(l+1)) from each coarser level to the one above it, on
    which the matrices are Galerkin's. One sweep of Gauss and Seidel forward before the correction,
    one backward after it: the cycle is linear, symmetric and positive definite. The last level is
    solved directly; with no other the cycle is that solution.
    """

    def __init__(self, matrix: csr_array, prolongations: Sequence[csr_array]) -> None:
        self._matrices, self._prolongations = [csr_array(matrix)], list(prolongations)
        for prolongation in prolongations:
            finer = self._matrices[-1]
            self._matrices.append(csr_array(prolongation.T @ finer @ prolongation))
        self._restrictions = [csr_array(prolongation.T) for prolongation in prolongations]
        self._diagonals = [level.diagonal() for level in self._matrices]
        last = csc_array(self._matrices[-1])
        self._coarsest = splu(last, permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)

    def cycle(self, right: Array, level: int = 0) -> Array:
        """Return about the inverse of the ``level``'s matrix times ``right`` (n, k)."""
        if level == len(self._prolongations):
            return np.asarray(self._coarsest.solve(right))
        matrix, diagonal = self._matrices[level], self._diagonals[level]
        entries = matrix.indptr, matrix.indices, matrix.data, diagonal
        found = np.zeros_like(right)
        sweep(*entries, right, found, False)
        rest = self._restrictions[level] @ (right - matrix @ found)
        found += self._prolongations[level] @ self.cycle(rest, level + 1)
        sweep(*entries, right, found, True)
        return found

    def solve(self, right: Array, cycles: int) -> Array:
        """Return the inverse times ``right`` (n, k), which so many ``cycles`` come close to.

        Linear in ``right``. A single level takes one, and is exact.
        """
        found = self.cycle(right)
        for _ in range(cycles - 1 if self._prolongations else 0):
            found += self.cycle(right - self._matrices[0] @ found)
        return found


@compiled
def sweep(
    starts: NDArray[np.int32],
    columns: NDArray[np.int32],
    values: Array,
    diagonal: Array,
    right: Array,
    x: Array,
    back: bool,
) -> None:
    """Improve ``x`` by one sweep of Gauss and Seidel over the rows of a sparse matrix.

    Parameters
    ----------
    starts, columns, values
        The matrix (n, n), row by row: ``indptr``, ``indices`` and ``data``.
    diagonal
        Its diagonal (n,), without a 0.
    right, x
        Right-hand side and unknowns (n, k), the latter changed in place.
    back
        Whether from the last row to the first.
    """
    count, width = right.shape
    rest = np.empty(width)
    for turn in range(count):
        i = count - 1 - turn if back else turn
        for d in range(width):
            rest[d] = right[i, d]
        for q in range(starts[i], starts[i + 1]):
            for d in range(width):
                rest[d] -= values[q] * x[columns[q], d]
        for d in range(width):
            x[i, d] += rest[d] / diagonal[i]
