"""A tank that stands still."""

from __future__ import annotations

import numpy as np

from coupling.motion.kind import MotionKind, TankMotion
from coupling.ports import Array
from coupling.scene.sections import Motion


class RestMotion:
    """A tank that stands still."""

    def displacement(self, time: float) -> Array:
        """Zero [m]."""
        return np.zeros(3)

    def velocity(self, time: float) -> Array:
        """Zero [m/s]."""
        return np.zeros(3)

    def acceleration(self, time: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Zero [m/s^2]."""
        return np.zeros(3)


class Rest(MotionKind):
    """No motion: the settled diaphragm is left to itself."""

    moves = False

    def motion(self, section: Motion) -> TankMotion:
        """None."""
        del section
        return RestMotion()

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """That there is none."""
        del section
        return ("none",)


REST = Rest()
