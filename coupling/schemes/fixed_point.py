"""The fixed point itself: structure and flow in turn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from coupling.ports import Array, SchemeSettings


class FixedPoint:
    """x <- x + omega r. With omega = 1 it diverges where the liquid is heavier than the wall."""

    takes_inertia: ClassVar[bool] = False
    typical_iterations: ClassVar[float] = 35.0

    def __init__(self, relaxation: float = 1.0) -> None:
        self.relaxation = relaxation

    @classmethod
    def of(cls, settings: SchemeSettings) -> FixedPoint:
        """Return the scheme, which has no settings: the plain fixed point takes no relaxation."""
        del settings
        return cls()

    def begin_step(self) -> None:
        """Do nothing: nothing is kept within a step."""

    def update(self, x: Array, residual: Array) -> Array:
        """Return the next iterate x + omega r, with the constant ``relaxation`` omega.

        Parameters
        ----------
        x
            Interface vector (k,), of any unit.
        residual
            Residual r = S(F(x)) - x at ``x`` (k,), in its unit.

        Returns
        -------
        Array
            The next interface vector (k,).
        """
        return x + self.relaxation * residual

    def accept_step(self, x: Array, residual: Array) -> None:
        """Do nothing: nothing is kept between steps.

        Parameters
        ----------
        x
            Interface vector (k,) that the step ends at; not used.
        residual
            Residual at ``x`` (k,); not used.
        """

    def save(self) -> dict[str, Array]:
        """Return no arrays: the scheme keeps no state between steps."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Do nothing: the scheme keeps no state between steps."""
