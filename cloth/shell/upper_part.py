"""A mould of the shell's own shape."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array
from cloth.shell.shell import Shell


class UpperPart:
    """The part of a ``shell`` above its rim (a ``Mould``)."""

    def __init__(self, shell: Shell) -> None:
        self.shell, self.length = shell, shell.arc_to(shell.poles[1])

    def ring(self, number: int, rings: int) -> tuple[float, float]:
        """Return radius and height [m] of a parallel circle, see ``Mould``; exact at the rim."""
        if number in (0, rings):
            return (self.shell.size, 0.0) if number else (0.0, self.shell.poles[1])
        r, z = self.shell.along(np.array([self.length * (1.0 - number / rings)]))
        return float(r[0]), float(z[0])

    def directions(self, points: Array) -> Array:
        """Map ``points`` (n, 3) [m] to the unit hemisphere (n, 3), as the chart of ``Mould``."""
        height = self.shell.project(points)[:, 2]
        polar = [0.5 * np.pi * (1.0 - self.shell.arc_to(z) / self.length) for z in height.tolist()]
        across = np.hypot(points[:, 0], points[:, 1])
        outward = points[:, :2] / np.where(across > 0.0, across, 1.0)[:, None]
        return np.column_stack([np.sin(polar)[:, None] * outward, np.cos(polar)])
