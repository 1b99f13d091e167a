"""A sphere about the origin, clamped at its equator."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.mould import Hemisphere
from cloth.shell.part import ShellPart

SMALLEST = 1e-30  # m from the centre, where a sphere's normal is no longer asked for


class Sphere:
    """The sphere of ``radius`` [m] about the origin (a ``Shell``, all in closed form)."""

    def __init__(self, radius: float) -> None:
        self.radius = self.size = radius
        self.poles = -radius, radius
        self.profile: Array = np.array([[radius]])

    def gap(self, x: Array) -> Array:
        """Return the distance (n,) [m] of ``x`` (n, 3) [m] from the shell, below 0 outside."""
        return np.asarray(self.radius - np.linalg.norm(x, axis=1))

    def normal(self, x: Array) -> Array:
        """Return outward unit normals (n, 3) where the shell is nearest to ``x`` (n, 3) [m]."""
        return np.asarray(x / np.maximum(np.linalg.norm(x, axis=1), SMALLEST)[:, None])

    def project(self, x: Array) -> Array:
        """Return the shell's nearest points (n, 3) [m] to ``x`` (n, 3) [m]."""
        distance = np.maximum(np.linalg.norm(x, axis=1), SMALLEST)
        return np.asarray(x * (self.radius / distance)[:, None])

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """Return points moved to a depth inside the shell where they lie less deep.

        Parameters
        ----------
        x
            Points (n, 3) [m].
        depth
            Least depth over the radius (n,) [-].

        Returns
        -------
        Array
            The points (n, 3) [m].
        """
        distance = np.maximum(np.linalg.norm(x, axis=1), SMALLEST)
        most = (1.0 - np.asarray(depth)) * self.radius
        return np.asarray(x * np.minimum(1.0, most / distance)[:, None])

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
        square = float(shift @ shift)
        if square <= 0.0:
            return 1.0
        half = start @ shift
        room = np.maximum(self.radius**2 - np.sum(start**2, axis=1), 0.0)
        share = (np.sqrt(half**2 + square * room) - half) / square
        return float(np.clip(share, 0.0, 1.0).min())

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Return the meridian's radius and height (n,) [m] at ``arc`` (n,) [m] above the rim.

        ``arc`` is measured along the meridian.
        """
        angle = arc / self.radius
        return self.radius * np.cos(angle), self.radius * np.sin(angle)

    def arc_to(self, height: float) -> float:
        """Return the arc length [m] from the rim up to ``height`` [m], the reverse of ``along``."""
        return self.radius * math.asin(height / self.radius)

    @property
    def volume(self) -> float:
        """Volume of the whole inside [m^3]."""
        return 4.0 / 3.0 * math.pi * self.radius**3

    def volume_below(self, height: float) -> float:
        """Return the volume [m^3] inside, below the plane z = ``height`` [m]."""
        half = 2.0 / 3.0 * math.pi * self.radius**3
        return half + math.pi * height * (self.radius**2 - height**2 / 3.0)

    def moment_below(self, height: float) -> float:
        """Return int z dV [m^4] over the inside below the plane z = ``height`` [m]."""
        half = -math.pi * self.radius**4 / 4.0
        return half + math.pi * height**2 * (0.5 * self.radius**2 - 0.25 * height**2)

    def level_of(self, volume: float, up: Array) -> float:
        """Return the height [m] above the origin, along ``up`` (3,), of a level liquid's surface.

        ``volume`` [m^3], from 0 to the sphere's; the direction makes no difference.
        """
        return (level_of_fill_fraction(volume / self.volume) - 1.0) * self.radius

    def on_rays(self, directions: Array) -> Array:
        """Return where rays from the origin meet the shell (n, 3) [m].

        ``directions`` (n, 3): unit vectors along the rays.
        """
        return np.asarray(self.radius * directions)

    def scaled(self, factor: float) -> Sphere:
        """Return the shell ``factor`` times as large, about the origin."""
        return Sphere(factor * self.radius)

    def quadrature(self, degree: int, height: float = 0.0) -> tuple[Array, Array]:
        """Return points (n, 3) [m] below z = ``height`` [m] and their outward areas (n, 3) [m^2].

        Exact for products of two polynomials of ``degree``, one times the normal: Gauss's points in
        height, even ones around.
        """
        count, level = degree + 1, height / self.radius
        node, weight = np.polynomial.legendre.leggauss(count)
        z, weight = 0.5 * (level - 1.0) + 0.5 * (level + 1.0) * node, 0.5 * (level + 1.0) * weight
        angle = np.pi * np.arange(2 * count) / count
        across = np.sqrt(1.0 - z**2)[:, None]
        normal = np.empty((count, 2 * count, 3))
        normal[..., 0], normal[..., 1] = across * np.cos(angle), across * np.sin(angle)
        normal[..., 2] = z[:, None]
        outward: Array = normal.reshape(-1, 3)
        size = np.repeat(weight * np.pi / count, 2 * count) * self.radius**2
        return self.radius * outward, size[:, None] * outward

    def upper_part(self) -> Hemisphere:
        """Return the mould of a sheet that lies on the shell above the rim."""
        return Hemisphere(self.radius)

    def lower_part(self) -> ShellPart:
        """Return the mould of a sheet that lies on the shell below the rim."""
        return ShellPart(self, below=True)


def level_of_fill_fraction(fill_fraction: float) -> float:
    """Return the depth h/R of a sphere filled to ``fill_fraction``.

    The root of h^2 (3 - h) = 4 FF in [0, 2]: the cap's volume is pi h^2 (3 - h) R^3/3. The cubic is
    solved exactly by Viete's cosine. Raises ValueError outside [0, 1].
    """
    if not 0.0 <= fill_fraction <= 1.0:
        raise ValueError(f"fill fraction: must lie in [0, 1], got {fill_fraction:g}.")
    angle = (np.arccos(1.0 - 2.0 * fill_fraction) + 4.0 * np.pi) / 3.0
    return float(np.clip(1.0 + 2.0 * np.cos(angle), 0.0, 2.0))


def fill_fraction_of_level(level: float) -> float:
    """Return the fill fraction h^2 (3 - h)/4 for the depth h = ``level`` in radii.

    The inverse of ``level_of_fill_fraction``.
    """
    return level**2 * (3.0 - level) / 4.0
