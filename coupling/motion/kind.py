"""What a kind of motion says of itself, and what it makes of a scene's section."""

from __future__ import annotations

from typing import ClassVar, Protocol

import numpy as np

from coupling.ports import Array
from coupling.scene.motion_table import MotionTable
from coupling.scene.sections import Motion


class TankMotion(Protocol):
    """Motion of the tank's origin in the laboratory's axes; ``time`` [s], all results (3,)."""

    def displacement(self, time: float) -> Array:
        """From where the tank stood at time 0 [m]."""

    def velocity(self, time: float) -> Array:
        """[m/s]."""

    def acceleration(self, time: float) -> Array:
        """[m/s^2]."""

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """The one that drives a time step from ``start`` to ``end`` [s], solved at its end.

        ``previous`` [s]: length of the step before, 0 where there was none.
        """

    def working_acceleration(self, start: float, end: float) -> Array:
        """The one whose product with what moves in the step is the tank's work."""


class Attitude(Protocol):
    """A tank that turns; ``time`` [s]. Vectors are in the tank's own axes at that time.

    ``sampled``: whether its acceleration is that of samples, which steps take the mean of.
    """

    sampled: bool

    def matrix(self, time: float) -> Array:
        """R (3, 3): a vector v in the tank's axes is R v in the laboratory's."""

    def rate(self, time: float) -> Array:
        """omega (3,) [rad/s]."""

    def acceleration(self, time: float) -> Array:
        """d(omega)/dt (3,) [rad/s^2]."""


class MotionKind:
    """A kind of motion: what a scene, the run and the report ask of it.

    What stands here is that of a motion without a period, which needs no keys.
    """

    needs: ClassVar[tuple[str, ...]] = ()  # keys of the section that have to be given
    takes: ClassVar[tuple[str, ...]] = ()  # keys of the section that may be given
    reads_file: ClassVar[bool] = False  # whether ``motion.file`` is its data
    moves: ClassVar[bool] = True
    gentler: ClassVar[str] = ""  # what to change for less of it, as a message's mend

    def motion(self, section: Motion) -> TankMotion:
        """The tank's motion that ``section`` describes."""
        raise NotImplementedError

    def attitude(self, section: Motion) -> Attitude | None:
        """How it turns the tank, None where it does not; ``motion`` is then the origin's."""
        del section
        return None

    def turns(self, section: Motion) -> bool:
        """Whether the tank turns; no more than that is asked of a section with problems."""
        return self.attitude(section) is not None

    def record(self, section: Motion) -> MotionTable | None:
        """The accelerations, measured or made, that it follows, None where it follows none."""
        del section
        return None

    def problems(self, section: Motion, end: float, step: float) -> list[str]:
        """One line ``key: what is wrong. Mend.`` each, of a run to ``end`` [s] in ``step`` s."""
        del section, end, step
        return []

    def frequency(self, section: Motion) -> float | None:
        """Of a periodic motion [Hz], None of any other."""
        del section
        return None

    def characteristic_frequency(self, section: Motion) -> float:
        """[Hz], 0 where nothing moves."""
        return self.frequency(section) or 0.0

    def peak_accelerations(self, section: Motion) -> Array:
        """Accelerations (k, 3) [m/s^2] of the tank among which the largest are."""
        del section
        return np.zeros((1, 3))

    def instants(self, section: Motion) -> Array:
        """Times (k,) [s] of which a turning tank's largest accelerations are taken."""
        raise NotImplementedError

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """The motion in a few words or values with their units, for a report's table."""
        del section
        return ()
