"""Regular solid harmonics: all polynomials up to a degree that satisfy Laplace's equation.

R_lm = r^l P_lm(cos theta) e^(i m phi) / (l + m)!, without the Condon-Shortley sign, obeys

    (l + m)(l - m) R_lm = (2l - 1) z R_(l-1)m - r^2 R_(l-2)m,
    d/dz R_lm = R_(l-1)m,  (d/dx +- i d/dy) R_lm = -+ R_(l-1)(m +- 1),

so that a gradient is a combination of harmonics one degree lower (Epton and Dembart, SIAM J. Sci.
Comput. 16, 1995, with other signs).
"""

from __future__ import annotations

import math

import numpy as np

from cloth.compiled import compiled
from coupling.ports import Array, Ints, Shell


class SolidHarmonics:
    """The (L + 1)^2 real harmonics of degree 0 to L = ``degree``, in units of ``radius`` [m].

    Each has the mean square 1 over the sphere of that radius. ``degrees`` (k,) of all of them, in
    rising order; ``slopes`` (3, k, k) [1/m]: harmonic j's share in the derivative of harmonic i is
    ``slopes[axis, j, i]``.
    """

    def __init__(self, degree: int, radius: float) -> None:
        self.degree, self.radius = degree, radius
        self._keys = [(n, m) for n in range(degree + 1) for m in range(-n, n + 1)]
        self._place = {key: k for k, key in enumerate(self._keys)}
        self.degrees: Ints = np.array([n for n, _ in self._keys])
        self._scale = np.array([_norm(n, abs(m)) for n, m in self._keys])
        self.slopes = self._slopes()

    def values(self, points: Array) -> Array:
        """Return all harmonics (N, k) [-] at ``points`` (N, 3) [m]."""
        found = np.empty((len(points), len(self._keys)))
        harmonics_at(np.ascontiguousarray(points) / self.radius, self.degree, self._scale, found)
        return found

    def _slopes(self) -> Array:
        """Signed m: the real part for m >= 0, the imaginary part for m < 0."""
        slopes = np.zeros((3, len(self._keys), len(self._keys)))

        def add(axis: int, n: int, m: int, column: int, share: float) -> None:
            if (n, m) in self._place:
                row = self._place[n, m]
                slopes[axis, row, column] += share * self._scale[column] / self._scale[row]

        for column, (n, m) in enumerate(self._keys):
            add(2, n - 1, m, column, 1.0)
            order = abs(m)
            if m == 0:
                add(0, n - 1, 1, column, -1.0)
                add(1, n - 1, -1, column, -1.0)
            elif m > 0:
                add(0, n - 1, order - 1, column, 0.5)
                add(0, n - 1, order + 1, column, -0.5)
                add(1, n - 1, -(order + 1), column, -0.5)
                if order > 1:
                    add(1, n - 1, -(order - 1), column, -0.5)
            else:
                add(0, n - 1, -(order + 1), column, -0.5)
                if order > 1:
                    add(0, n - 1, -(order - 1), column, 0.5)
                add(1, n - 1, order + 1, column, 0.5)
                add(1, n - 1, order - 1, column, 0.5)
        return slopes / self.radius


def harmonics_in(shell: Shell, degree: int) -> SolidHarmonics:
    """Return the harmonics up to ``degree`` in units of how far ``shell`` reaches from the origin.

    In units of its rim's radius those of a long tank are so unequal that the least stiffness of
    ``ritz`` cuts true ones off: in a pill of 2:1 its lowest mode then errs by 3 % at degree 12.
    """
    return SolidHarmonics(degree, max(shell.size, *map(abs, shell.poles)))


def _norm(n: int, m: int) -> float:
    """Factor that gives the real or imaginary part of R_nm the mean square 1 on the unit sphere."""
    square = (2 * n + 1) * math.factorial(n + m) * math.factorial(n - m)
    return math.sqrt(square * (1 if m == 0 else 2))


@compiled
def harmonics_at(points: Array, degree: int, scale: Array, found: Array) -> None:
    """Fill ``found`` with all harmonics up to a degree at given points.

    Parameters
    ----------
    points
        Points (N, 3), over the radius that the harmonics are in units of.
    degree
        Highest degree L; there are k = (L + 1)^2 harmonics.
    scale
        Factor of every harmonic (k,) [-].
    found
        Values (N, k) [-], filled here: harmonic (n, m) stands at n^2 + n + m, the imaginary part of
        R_n|m| where m is negative.
    """
    for i in range(points.shape[0]):
        x, y, z = points[i]
        square = x * x + y * y + z * z
        real, imaginary = 1.0, 0.0
        for m in range(degree + 1):
            if m:
                real, imaginary = (
                    (x * real - y * imaginary) / (2 * m),
                    (x * imaginary + y * real) / (2 * m),
                )
            below_real, below_imaginary, here_real, here_imaginary = 0.0, 0.0, real, imaginary
            for n in range(m, degree + 1):
                if n > m:
                    rise, fall = (2 * n - 1) * z, 1.0 / ((n + m) * (n - m))
                    below_real, here_real = (
                        here_real, (rise * here_real - square * below_real) * fall,
                    )  # fmt: skip
                    below_imaginary, here_imaginary = (
                        here_imaginary, (rise * here_imaginary - square * below_imaginary) * fall,
                    )  # fmt: skip
                place = n * n + n
                found[i, place + m] = here_real * scale[place + m]
                if m:
                    found[i, place - m] = here_imaginary * scale[place - m]
