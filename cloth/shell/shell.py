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
        """Return the distance (n,) [m] of ``x`` (n, 3) [m] from the shell, below 0 outside."""

    def normal(self, x: Array) -> Array:
        """Return outward unit normals (n, 3) where the shell is nearest to ``x`` (n, 3) [m]."""

    def project(self, x: Array) -> Array:
        """Return the shell's nearest points (n, 3) [m] to ``x`` (n, 3) [m]."""

    def confine(self, x: Array) -> Array:
        """Return ``x`` (n, 3) [m] with what lies outside moved to the shell's nearest point."""

    def share_within(self, start: Array, shift: Array) -> float:
        """Return the largest share of a shift that keeps all points inside.

        Parameters
        ----------
        start
            Points (k, 3) [m], inside the shell.
        shift
            The shift of all of them (3,) [m].

        Returns
        -------
        float
            Share in [0, 1].
        """

    def volume_below(self, height: float) -> float:
        """Return the volume [m^3] inside, below the plane z = ``height`` [m]."""

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Return the meridian's radius and height (n,) [m] at ``arc`` (n,) [m] above the rim.

        ``arc`` is measured along the meridian.
        """

    def arc_to(self, height: float) -> float:
        """Return the arc length [m] from the rim up to ``height`` [m], the reverse of ``along``."""


class NoShell:
    """A sheet that nothing surrounds: the volume is that of the cone over it from the origin."""

    size = 1.0
    poles = (0.0, 0.0)
    profile = np.zeros((0, 1))

    def gap(self, x: Array) -> Array:
        """Return infinite distances (n,)."""
        return np.full(len(x), np.inf)

    def normal(self, x: Array) -> Array:
        """Return zeros (n, 3): there are no normals."""
        return np.zeros_like(x)

    def project(self, x: Array) -> Array:
        """Return ``x`` (n, 3) [m] itself."""
        return x

    def confine(self, x: Array) -> Array:
        """Return ``x`` (n, 3) [m] itself."""
        return x

    def share_within(self, start: Array, shift: Array) -> float:
        """Return 1: nothing limits a shift.

        Parameters
        ----------
        start, shift
            Points (k, 3) [m] and their shift (3,) [m], of no effect.
        """
        return 1.0

    def volume_below(self, height: float) -> float:
        """Return 0: no volume lies below the rim."""
        return 0.0

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Raise ValueError: there is no meridian."""
        raise ValueError("cloth: there is no shell.")

    def arc_to(self, height: float) -> float:
        """Raise ValueError: there is no meridian."""
        raise ValueError("cloth: there is no shell.")


NO_SHELL = NoShell()
