"""What the flow's mesh asks of a tank's walls, however the tank lies: parts of a ``Shell``."""

from __future__ import annotations

from typing import Protocol

from coupling.ports.arrays import Array


class Confinement(Protocol):
    """What keeps the mesh in."""

    @property
    def size(self) -> float:
        """Radius [m] of the rim's circle, over which lengths are taken."""

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """``x`` (n, 3) [m], what lies less than ``depth`` (n,) sizes inside moved to there."""


class OnRays(Protocol):
    """What the mesh's points on the walls stand on."""

    def on_rays(self, directions: Array) -> Array:
        """Where rays from the origin in ``directions`` (n, 3), of length 1, meet it (n, 3) [m]."""
