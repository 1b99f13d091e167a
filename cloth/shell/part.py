"""A mould of the shell's own shape, above or below its rim."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array
from cloth.shell.shell import Shell


class ShellPart:
    """The part of a ``shell`` above its rim, or ``below`` it (a ``Mould``)."""

    def __init__(self, shell: Shell, *, below: bool = False) -> None:
        self.shell, self._side = shell, -1.0 if below else 1.0
        self._pole = shell.poles[0 if below else 1]
        self.length = self._side * shell.arc_to(self._pole)

    def ring(self, number: int, rings: int) -> tuple[float, float]:
        """Return radius and height [m] of a parallel circle, see ``Mould``; exact at the rim."""
        if number in (0, rings):
            return (self.shell.size, 0.0) if number else (0.0, self._pole)
        arc = self._side * self.length * (1.0 - number / rings)
        r, z = self.shell.along(np.array([arc]))
        return float(r[0]), float(z[0])

    def directions(self, points: Array) -> Array:
        """Map ``points`` (n, 3) [m] to the unit hemisphere (n, 3), as the chart of ``Mould``."""
        height = self.shell.project(points)[:, 2]
        arc = self._side * np.array([self.shell.arc_to(z) for z in height.tolist()])
        polar = 0.5 * np.pi * (1.0 - arc / self.length)
        across = np.hypot(points[:, 0], points[:, 1])
        outward = points[:, :2] / np.where(across > 0.0, across, 1.0)[:, None]
        return np.column_stack([np.sin(polar)[:, None] * outward, np.cos(polar)])
