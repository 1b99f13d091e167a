"""What a diaphragm and a liquid ask of the shell they are in."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from cloth.arrays import Array


class Shell(Protocol):
    """A rigid closed surface of revolution about z, and its inside.

    The origin is the middle of the circle in the plane z = 0 on which the rim is clamped, and every
    point of the shell is seen from it. Points are (n, 3) [m].
    """

    @property
    def profile(self) -> Array:
        """The surface as compiled code has it (``cloth.shell.kernels``)."""

    @property
    def size(self) -> float:
        """Radius [m] of the rim's circle, over which lengths are taken."""

    @property
    def poles(self) -> tuple[float, float]:
        """Heights [m] of the lower and the upper pole."""

    def gap(self, x: Array) -> Array:
        """Distance (n,) [m] of ``x`` (n, 3) from the shell, below 0 outside."""

    def normal(self, x: Array) -> Array:
        """Outward unit normals (n, 3) where the shell is nearest to ``x`` (n, 3)."""

    def project(self, x: Array) -> Array:
        """The shell's nearest points (n, 3) to ``x`` (n, 3)."""

    def confine(self, x: Array) -> Array:
        """``x`` (n, 3), what lies outside at the shell's nearest point."""

    def share_within(self, start: Array, shift: Array) -> float:
        """Largest share in [0, 1] of ``shift`` (3,) that keeps ``start`` (k, 3) inside."""

    def volume_below(self, height: float) -> float:
        """Volume [m^3] inside, below the plane z = ``height`` [m]."""

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Radius and height (n,) [m] of the meridian ``arc`` (n,) [m] above the rim, along it."""

    def arc_to(self, height: float) -> float:
        """The reverse of ``along``: arc length [m] from the rim up to ``height`` [m]."""


class NoShell:
    """A sheet that nothing surrounds: the volume is that of the cone over it from the origin."""

    size = 1.0
    poles = (0.0, 0.0)
    profile = np.zeros((0, 1))

    def gap(self, x: Array) -> Array:
        """Infinite (n,)."""
        return np.full(len(x), np.inf)

    def normal(self, x: Array) -> Array:
        """None: zeros (n, 3)."""
        return np.zeros_like(x)

    def project(self, x: Array) -> Array:
        """``x`` (n, 3) itself."""
        return x

    def confine(self, x: Array) -> Array:
        """``x`` (n, 3) itself."""
        return x

    def share_within(self, start: Array, shift: Array) -> float:
        """1."""
        return 1.0

    def volume_below(self, height: float) -> float:
        """0."""
        return 0.0

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Raises ValueError."""
        raise ValueError("cloth: there is no shell.")

    def arc_to(self, height: float) -> float:
        """Raises ValueError."""
        raise ValueError("cloth: there is no shell.")


NO_SHELL = NoShell()
