"""What the iterations of a step have left."""

from __future__ import annotations


class History:
    """Relative residuals of a step's iterations, ``maps`` by the map they were met on."""

    def __init__(self) -> None:
        self.maps: list[list[float]] = []

    def begin_map(self) -> None:
        """Go on with another map."""
        self.maps.append([])

    def add(self, residual: float) -> None:
        """Append what an iteration on the present map has left."""
        self.maps[-1].append(residual)

    @property
    def on_map(self) -> list[float]:
        """Those on the present map."""
        return self.maps[-1]

    @property
    def residuals(self) -> list[float]:
        """All of them."""
        return [residual for residuals in self.maps for residual in residuals]
