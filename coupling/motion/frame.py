"""The frame in which a run is computed: what it adds to gravity, and where it stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.motion.kind import TankMotion
from coupling.motion.shaking import motion_of
from coupling.ports import Array
from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The frame whose origin moves with the tank's by ``motion``, and which never turns.

    In it a body force b = g - a, the field of ``gravity`` (3,) [m/s^2] less the origin's
    acceleration, is the same everywhere, and so a gradient: the liquid's pressure is
    p0 + rho b.x + p*, and p* has no source but what the boundary does. In a frame that turned with
    the tank Euler's force would be no gradient.
    """

    gravity: Array
    motion: TankMotion

    def body_force(self, start: float, end: float, previous: float) -> Array:
        """b (3,) [m/s^2] of a step from ``start`` to ``end`` [s], solved at its end.

        ``previous`` [s]: length of the step before, 0 where there was none.
        """
        return self.gravity - self.motion.step_acceleration(start, end, previous)

    def acceleration(self, start: float, end: float) -> Array:
        """Of the origin (3,) [m/s^2] at the ``end`` [s] of a step; of a record its mean over it."""
        return self.motion.step_acceleration(start, end, 0.0)

    def working_acceleration(self, start: float, end: float) -> Array:
        """The one (3,) [m/s^2] whose product with what moves in the step is the tank's work."""
        return self.motion.working_acceleration(start, end)

    def displacement(self, time: float) -> Array:
        """Of the origin (3,) [m], from where it stood at time 0."""
        return self.motion.displacement(time)


def frame_of(scene: Scene) -> Frame:
    """That of the scene's gravity and motion."""
    return Frame(gravity=np.array(scene.gravity), motion=motion_of(scene))
