"""The linear system of one iteration: a constant sparse matrix and a low-rank inertia of liquid."""

from __future__ import annotations

import numpy as np
import scipy.linalg as sl
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from cloth.arrays import Array, Bools, Ints
from cloth.factors import factor_of


def stretch_matrix(triangles: Ints, gradients: Array, weight: Array, size: int) -> sp.csc_matrix:
    """Return the Laplacian in the moulded metric, sum_t weight_t g_t g_t^T.

    Parameters
    ----------
    triangles
        Nodes of each triangle (m, 3).
    gradients
        g (m, 3, 2) [1/m], as ``cloth.mesh.rest_gradients`` returns them.
    weight
        Weight of each triangle (m,) [N m]: a stiffness times an area.
    size
        Number n of nodes.

    Returns
    -------
    csc_matrix
        The matrix (n, n) [N/m], the same for x, y and z; [-] where ``weight`` is an area.
    """
    blocks = weight[:, None, None] * np.einsum("tie,tje->tij", gradients, gradients)
    rows = np.repeat(triangles[:, :, None], 3, axis=2)
    columns = np.repeat(triangles[:, None, :], 3, axis=1)
    return sp.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))


class System:
    """The linear system of a step, factorised: fixed nodes hold their position.

    A = S (x) I_3 + B^T B on the free nodes, less what a free tank's recoil takes.
    S (n, n) [N/m] is symmetric positive definite and the same for x, y and z.
    """

    def __init__(self, matrix: sp.csc_matrix, free: Bools) -> None:
        self._free = np.flatnonzero(free)
        self.count = len(free)
        inner = sp.csc_matrix(matrix[self._free][:, self._free])
        factor = spl.splu(
            inner,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
        assert np.array_equal(factor.perm_r, factor.perm_c), "S lost its symmetric ordering"
        self._order = self._free[np.argsort(factor.perm_c)]
        lower = sp.csc_matrix(sp.tril(factor.L, -1, format="csc"))
        lower.sort_indices()
        self._factor = factor_of(
            lower.indptr.astype(np.int64), lower.indices.astype(np.int64),
            lower.data, factor.U.diagonal(),
        )  # fmt: skip
        self._boundary = sp.csr_matrix(matrix[self._free][:, np.flatnonzero(~free)])
        self._directions: Array | None = None
        self._recoil: tuple[Array, Array] | None = None

    @property
    def fill(self) -> int:
        """Number of entries of L below its diagonal."""
        return len(self._factor.values)

    def lift(self, positions: Array, fixed: Bools) -> Array:
        """Return what fixed nodes at ``positions`` (n, 3) [m] add to the right-hand side.

        ``fixed`` (n,) are those nodes. Forces (n, 3) [N], zero on the fixed nodes.
        """
        result = np.zeros_like(positions)
        result[self._free] = -(self._boundary @ positions[fixed])
        return result

    def add_mass(self, rows: Array | None) -> None:
        """Take in B = ``rows`` (r, n, 3) [sqrt(N/m)], or drop what was taken in.

        Woodbury with C = 1 + B S^-1 B^T = K K^T and Z = K^-1 B S^-1: A^-1 = S^-1 - Z^T Z.
        What ``take_recoil`` took in is dropped.
        """
        self._recoil = None
        if rows is None or len(rows) == 0:
            self._directions = None
            return
        rank = len(rows)
        inner = rows[:, self._order, :]
        right = np.ascontiguousarray(inner.transpose(1, 0, 2)).reshape(len(self._order), 3 * rank)
        solved = self._factor.solved(right)
        y = solved.reshape(-1, rank, 3).transpose(1, 0, 2).reshape(rank, -1)
        core = np.eye(rank) + inner.reshape(rank, -1) @ y.T
        lower = sl.cholesky(core, lower=True, check_finite=False)
        inverse = sl.solve_triangular(lower, np.eye(rank), lower=True, check_finite=False)
        z = np.zeros((rank, self.count, 3))
        # A product is several times faster than substitution.
        z[:, self._order] = (inverse @ y).reshape(rank, -1, 3)
        self._directions = z.reshape(rank, -1)

    def take_recoil(self, push: Array, pull: Array) -> None:
        """Take away ``push``^T ``pull``, both (k, n, 3) [sqrt(N/m)], until ``add_mass`` is next.

        Woodbury again: (A - U^T V)^-1 = A^-1 + A^-1 U^T (1 - V A^-1 U^T)^-1 V A^-1.
        Raises ArithmeticError where what is left is no inertia.
        """
        pushed = np.stack([self.solve(row) for row in push]).reshape(len(push), -1)
        pulled = pushed
        if pull is not push:
            pulled = np.stack([self.solve(row) for row in pull]).reshape(len(pull), -1)
        core = np.eye(len(push)) - pull.reshape(len(pull), -1) @ pushed.T
        if not np.linalg.eigvals(core).real.min() > 0.0:
            raise ArithmeticError("cloth: the tank is too light for what moves in it.")
        self._recoil = np.asarray(np.linalg.solve(core.T, pushed)), pulled

    def solve(self, right: Array) -> Array:
        """Return A^-1 ``right`` (n, 3) [m], of forces [N]; zero on the fixed nodes."""
        x = np.zeros((self.count, 3))
        self._factor.solve(right, self._order, x)
        if self._directions is not None:
            # Plain products: the library's are three times faster than one pass over Z compiled.
            x -= ((self._directions @ right.ravel()) @ self._directions).reshape(-1, 3)
        if self._recoil is not None:
            pushed, pulled = self._recoil
            x += ((pulled @ right.ravel()) @ pushed).reshape(-1, 3)
        return x
