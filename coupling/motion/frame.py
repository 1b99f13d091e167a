"""The frame in which a run is computed: what it adds to gravity, and where it stands."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.motion.kind import Attitude, TankMotion
from coupling.motion.shaking import attitude_of, motion_of
from coupling.ports import Array, Turn
from coupling.scene.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Frame:
    """The frame whose origin moves with the tank's by ``motion``, and which never turns.

    In it a body force b = g - a, the field of ``gravity`` (3,) [m/s^2] less the origin's
    acceleration, is the same everywhere, and so a gradient: the liquid's pressure is
    p0 + rho b.x + p*, and p* has no source but what the boundary does. In a frame that turned with
    the tank Euler's force would be no gradient. A tank that turns by ``turning``, None where it
    does not, moves its boundaries alone. All of a step is given in the tank's axes at its end,
    which stand still for that step: R(end)^T b in place of b, and ``turn`` for what was before.
    """

    gravity: Array
    motion: TankMotion
    turning: Attitude | None = None

    def attitude(self, time: float) -> Array:
        """R (3, 3) at ``time`` [s]: v in the tank's axes is R v in those that do not turn."""
        return np.eye(3) if self.turning is None else self.turning.matrix(time)

    def rate(self, time: float) -> Array:
        """The tank's angular velocity (3,) [rad/s] at ``time`` [s], in its own axes then."""
        return np.zeros(3) if self.turning is None else self.turning.rate(time)

    def turn(self, start: float, end: float, previous: float) -> Turn | None:
        """How the tank turns in a step from ``start`` to ``end`` [s], None where it does not.

        ``previous`` [s]: length of the step before, 0 where there was none.
        """
        if self.turning is None:
            return None
        now = self.attitude(end)
        return Turn(
            attitude=self.attitude(0.0).T @ now,
            last=now.T @ self.attitude(start),
            before=now.T @ self.attitude(start - previous),
            rate=self.turning.rate(end),
            acceleration=self.turning.acceleration(end),
        )

    def body_force(self, start: float, end: float, previous: float) -> Array:
        """b (3,) [m/s^2] of a step from ``start`` to ``end`` [s], solved at its end.

        In the tank's axes there. ``previous`` [s]: length of the step before, 0 where there was
        none.
        """
        return self.in_tank(self.gravity - self.motion.step_acceleration(start, end, previous), end)

    def gravity_at(self, time: float) -> Array:
        """Gravity (3,) [m/s^2] at ``time`` [s], in the tank's axes."""
        return self.in_tank(self.gravity, time)

    def in_tank(self, vector: Array, time: float) -> Array:
        """A ``vector`` (3,) in axes that do not turn, in the tank's at ``time`` [s]."""
        return vector if self.turning is None else vector @ self.attitude(time)

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
    return Frame(
        gravity=np.array(scene.gravity), motion=motion_of(scene), turning=attitude_of(scene)
    )
