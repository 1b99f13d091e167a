"""Fixed point with Aitken's dynamic relaxation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.ports import Array, SchemeSettings
from coupling.schemes.fixed_point import FixedPoint


class Aitken(FixedPoint):
    """Dynamic relaxation (Irons & Tuck, IJNME 1, 1969; Kuettler & Wall, Comput. Mech. 43, 2008).

    omega_k+1 = -omega_k r_k . (r_k+1 - r_k) / |r_k+1 - r_k|^2. A step's first omega is the last
    step's, no larger than ``relaxation``.
    """

    def __init__(self, relaxation: float) -> None:
        super().__init__(relaxation)
        self._omega = relaxation
        self._previous: Array | None = None

    @classmethod
    def of(cls, settings: SchemeSettings) -> Aitken:
        """Return the scheme with the first relaxation of the scene."""
        return cls(settings.relaxation)

    def begin_step(self) -> None:
        """Drop the residual of the last step, and bound the relaxation as the papers do."""
        self._previous = None
        self._omega = float(np.sign(self._omega)) * min(abs(self._omega), self.relaxation)

    def update(self, x: Array, residual: Array) -> Array:
        """Return the next iterate x + omega r, with omega adapted to the change of the residual.

        Parameters
        ----------
        x
            Interface vector (k,), of any unit.
        residual
            Residual r = S(F(x)) - x at ``x`` (k,), in its unit.

        Returns
        -------
        Array
            The next interface vector (k,). On a step's first call omega is that of the step before,
            as ``begin_step`` bounds it; where the residual has not changed, omega stays.
        """
        if self._previous is not None:
            change = residual - self._previous
            length = float(change @ change)
            if length > 0:
                self._omega *= -float(self._previous @ change) / length
        self._previous = residual
        return x + self._omega * residual

    def save(self) -> dict[str, Array]:
        """Return the relaxation that the next step starts with."""
        return {"omega": np.array([self._omega])}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._omega = float(saved["omega"][0])
