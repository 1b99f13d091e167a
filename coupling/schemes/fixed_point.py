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
        """It has no settings: the plain fixed point takes no relaxation."""
        del settings
        return cls()

    def begin_step(self) -> None:
        """Nothing is kept within a step."""

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and its residual (k,)."""
        return x + self.relaxation * residual

    def accept_step(self, x: Array, residual: Array) -> None:
        """Nothing is kept between steps."""

    def save(self) -> dict[str, Array]:
        """No memory."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """No memory."""
