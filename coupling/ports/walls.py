"""The tank's walls: the shell as all ask of it, and what the flow's mesh does however it lies."""

from __future__ import annotations

from typing import Protocol

from coupling.ports.arrays import Array


class Shell(Protocol):
    """The tank's rigid shell, a closed surface of revolution about z, and its inside.

    The origin is the middle of the circle in the plane z = 0 on which the diaphragm is clamped, the
    rim; every point of the shell is seen from it. Points are (n, 3) [m].
    """

    @property
    def size(self) -> float:
        """Radius [m] of the rim's circle, over which lengths are taken."""

    @property
    def poles(self) -> tuple[float, float]:
        """Heights [m] of the lower and the upper pole."""

    @property
    def volume(self) -> float:
        """Of the whole inside [m^3]."""

    def gap(self, x: Array) -> Array:
        """Distance (n,) [m] of ``x`` (n, 3) from the shell, below 0 outside."""

    def normal(self, x: Array) -> Array:
        """Outward unit normals (n, 3) where the shell is nearest to ``x`` (n, 3)."""

    def project(self, x: Array) -> Array:
        """The shell's nearest points (n, 3) to ``x`` (n, 3)."""

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """``x`` (n, 3), what lies less than ``depth`` (n,) sizes inside moved to there."""

    def on_rays(self, directions: Array) -> Array:
        """Where rays from the origin in ``directions`` (n, 3), of length 1, meet it (n, 3) [m]."""

    def scaled(self, factor: float) -> Shell:
        """The shell ``factor`` times as large, about the origin."""

    def volume_below(self, height: float) -> float:
        """Volume [m^3] inside, below the plane z = ``height`` [m]."""

    def moment_below(self, height: float) -> float:
        """int z dV [m^4] over the inside below the plane z = ``height`` [m]."""

    def level_of(self, volume: float, up: Array) -> float:
        """Height [m] above the origin, along ``up`` (3,), of the surface of a level ``volume``."""

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Radius and height (n,) [m] of the meridian ``arc`` (n,) [m] above the rim, along it."""

    def arc_to(self, height: float) -> float:
        """The reverse of ``along``: arc length [m] from the rim up to ``height`` [m]."""

    def quadrature(self, degree: int, height: float = 0.0) -> tuple[Array, Array]:
        """Points (n, 3) [m] below z = ``height`` [m] and their outward area vectors (n, 3) [m^2].

        For products of two polynomials of ``degree``, one times the normal.
        """


class Confinement(Protocol):
    """What keeps the mesh in: a part of a ``Shell``."""

    @property
    def size(self) -> float:
        """Radius [m] of the rim's circle, over which lengths are taken."""

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """``x`` (n, 3) [m], what lies less than ``depth`` (n,) sizes inside moved to there."""


class OnRays(Protocol):
    """What the mesh's points on the walls stand on: a part of a ``Shell``."""

    def on_rays(self, directions: Array) -> Array:
        """Where rays from the origin in ``directions`` (n, 3), of length 1, meet it (n, 3) [m]."""
