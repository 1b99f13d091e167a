"""The fixed point itself: structure and flow in turn."""

from __future__ import annotations

from collections.abc import Mapping

from coupling.ports import Array


class FixedPoint:
    """x <- x + omega r. With omega = 1 it diverges where the liquid is heavier than the wall."""

    def __init__(self, relaxation: float = 1.0) -> None:
        self.relaxation = relaxation

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
