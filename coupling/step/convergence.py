"""When a coupled step counts as converged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.ports import Array


@dataclass(frozen=True, kw_only=True)
class Convergence:
    """rms(residual) <= tolerance * (rms(increment) + acceleration dt^2).

    The latter keeps the test meaningful for a step that hardly moves, as the first one from rest:
    with an ``acceleration`` [m/s^2] of |g|, an error of tolerance times that in the displacement
    changes the liquid's pressure by tolerance times its hydrostatic part.
    """

    tolerance: float
    acceleration: float

    def relative(self, residual: Array, increment: Array, dt: float) -> float:
        """Return the residual over what it is measured by; converged at or below ``tolerance``.

        Parameters
        ----------
        residual
            Displacement of the interface (p, 3) [m] that a further iteration would add.
        increment
            Displacement of the interface in the whole step (p, 3) [m].
        dt
            Length of the step [s].

        Returns
        -------
        float
            Relative residual [-].
        """
        return rms(residual) / (rms(increment) + self.acceleration * dt**2)

    def is_far(self, relative: list[float]) -> bool:
        """Return whether the ``relative`` residuals came less than half the way to the tolerance.

        In their logarithms, from the first to the last.
        """
        first, last = relative[0], relative[-1]
        return last / self.tolerance > first / last


def rms(vectors: Array) -> float:
    """Return the root mean square length of ``vectors`` (p, 3), in their unit."""
    return float(np.sqrt(np.mean(np.sum(vectors**2, axis=-1))))
