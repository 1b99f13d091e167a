"""A symmetric positive trace from the two boundary integral operators, and its derivatives.

With exact integrals K S is symmetric (Calderon), and G = (1/2 + K)^-1 S = S (S/2 + K S)^-1 S lies
above S: q^T G q is the energy of the liquid, q^T S q that of layers of sources, shared with the
other side. Here K S is symmetrised, and where a fold or a film is beyond the grid, so that an
eigenvalue t of 1/2 + K falls below 2 ``LEAST``, it counts as LEAST + t^2/(4 LEAST), t > 0, once
differentiable: no motion carries more than 1/LEAST times the liquid that its own sources do.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cho_solve, cholesky, eigh, solve_triangular

from coupling.ports import Array

LEAST = 0.01


class SymmetricTrace:
    """G of ``single`` S [1/m] and ``double`` K (F, F); ``closed`` where all walls are panels."""

    def __init__(self, single: Array, double: Array, *, closed: bool = False) -> None:
        self.single, self.double = 0.5 * (single + single.T), double
        product = double @ self.single
        self._product = 0.5 * (product + product.T)
        if closed:  # 1/2 + K has no inverse for a constant potential, which nobody asks for
            self._product += self.single.mean()
        self._factor: Array | None = None
        try:
            cholesky(self._product + (0.5 - 2 * LEAST) * self.single, lower=True)
            self._factor = cholesky(self._product + 0.5 * self.single, lower=True)
        except LinAlgError:
            self._decompose()

    def _decompose(self) -> None:
        """kappa and U with K S u = kappa S u, U^T S U = 1."""
        least = float(np.linalg.eigvalsh(self.single)[0])
        floor = 1e-3 * float(np.diag(self.single).min())
        if least < floor:  # a sheet that runs through itself within a face
            self.single.flat[:: len(self.single) + 1] += floor - least
        self._kappa, self._vectors = eigh(self._product, self.single)

    @property
    def limited(self) -> bool:
        """Whether an eigenvalue was near enough to the least that counts to be computed at all."""
        return self._factor is None

    def matrix(self) -> Array:
        """G (F, F) [1/m]."""
        if self._factor is not None:
            root = solve_triangular(self._factor, self.single, lower=True)
        else:
            root = (self.single @ self._vectors / np.sqrt(_kept(self._kappa)[0])).T
        return np.asarray(root.T @ root)

    def apply(self, flux: Array) -> Array:
        """G q (F,) [m^2/s] of ``flux`` q (F,) [m^3/s]."""
        loads = self.single @ flux
        if self._factor is not None:
            return np.asarray(self.single @ cho_solve((self._factor, True), loads))
        inverse = 1 / _kept(self._kappa)[0]
        return np.asarray(self.single @ (self._vectors @ (inverse * (self._vectors.T @ loads))))

    def slopes(self, flux: Array) -> tuple[Array, Array]:
        """Derivatives (F, F) of q^T G q by ``single`` and by ``double``, ``flux`` q held."""
        if self._factor is not None:
            y = cho_solve((self._factor, True), self.single @ flux)
            by_single = np.outer(y, 2 * flux - 0.5 * y) - np.outer(self.double.T @ y, y)
            return 0.5 * (by_single + by_single.T), np.outer(-y, self.single @ y)
        # In the basis U both matrices are diagonal, S = 1 and K S = kappa: G = 1/t(kappa).
        z = self._vectors.T @ (self.single @ flux)
        kept, slope = _kept(self._kappa)
        value, by_kappa = 1 / kept, -slope / kept**2
        apart = self._kappa[:, None] - self._kappa
        close = np.abs(apart) < 1e-7
        difference = np.where(
            close,
            0.5 * (by_kappa[:, None] + by_kappa),
            (value[:, None] - value) / np.where(close, 1.0, apart),
        )
        both = np.outer(z, z)
        by_product = self._vectors @ (both * difference) @ self._vectors.T
        mean = 0.5 * (value[:, None] + value)
        mean = mean - 0.5 * difference * (self._kappa[:, None] + self._kappa)
        by_single = self._vectors @ (both * mean) @ self._vectors.T
        by_single += self.double.T @ by_product
        return 0.5 * (by_single + by_single.T), by_product @ self.single


def _kept(kappa: Array) -> tuple[Array, Array]:
    """Eigenvalues of 1/2 + K (F,) as they count, and their derivative by ``kappa`` (F,)."""
    t = 0.5 + kappa
    low = np.maximum(t, 0.0)
    small = t < 2 * LEAST
    return np.where(small, LEAST + low**2 / (4 * LEAST), t), np.where(small, low / (2 * LEAST), 1.0)
