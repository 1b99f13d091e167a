"""What carries the tank in a run: its prescribed motion, or nothing but springs (``free_tank``)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Protocol

from coupling.motion.frame import Frame
from coupling.ports import Array, Recoil, Turn


class Carrier(Protocol):
    """What moves the tank; results are (3,), and all but the steps is of the committed state.

    ``recoil``: of the step opened last, None where nothing that the tank contains moves it;
    ``turn``: how the tank turns in that step, None where it does not.
    """

    recoil: Recoil | None
    turn: Turn | None

    def start(self, moment: Array, weight: Array) -> None:
        """At rest, the contents' first moment in the tank being ``moment`` (3,) [kg m].

        It is that of contents whose motion in the tank the tank feels; ``weight`` (3,) [kg m] is
        that of all that has weight.
        """

    def begin_step(self) -> None:
        """A step of the run begins, which may be taken in parts."""

    def body_force(self, start: float, end: float, previous: float) -> Array:
        """Open a part from ``start`` to ``end`` [s]; b [m/s^2] of it, but for the ``recoil``.

        ``previous`` [s]: length of the part before, 0 where there was none. In the tank's axes at
        the end, as are ``recoil`` and ``turn``; those of a tank that is free to turn are presumed.
        """

    def again(self, turned: Array) -> Array:
        """As ``body_force``, of the part that is open, with another attitude presumed at its end.

        ``turned`` (3,) [rad]: rotation vector from the one presumed before, in its axes.
        """

    def accept(self, moment: Callable[[], Array], body_force: Array, turned: Array) -> Array:
        """Commit the part that was opened last; b [m/s^2] at its end, in the tank's axes there.

        ``moment()`` (3,) [kg m] as in ``start``, there; ``body_force`` (3,): what opening it gave;
        ``turned`` (3,) [rad]: what is found beyond the attitude presumed.
        """

    def acceleration(self, start: float, end: float) -> Array:
        """Of the tank [m/s^2] at the ``end`` [s] of a step; of a record its mean over it."""

    def working_acceleration(self, start: float, end: float) -> Array:
        """The one [m/s^2] whose product with what moves in the step is the tank's work."""

    def displacement(self, time: float) -> Array:
        """Of the tank [m], from where it stood at time 0."""

    def attitude(self, time: float) -> Array | None:
        """R (3, 3), from the tank's axes to those that do not turn; None of one that never does."""

    def rate(self, time: float) -> Array:
        """Angular velocity [rad/s], in the tank's own axes."""

    def metrics(self) -> dict[str, float]:
        """Scalars for the results."""

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""


class Prescribed:
    """A tank that moves as its ``frame`` says, whatever it contains."""

    recoil: Recoil | None = None

    def __init__(self, frame: Frame) -> None:
        self.frame = frame
        self.turn: Turn | None = None

    def start(self, moment: Array, weight: Array) -> None:
        """Nothing: what it contains does not move it."""

    def begin_step(self) -> None:
        """Nothing is counted from here."""

    def body_force(self, start: float, end: float, previous: float) -> Array:
        """That of the frame."""
        self.turn = self.frame.turn(start, end, previous)
        return self.frame.body_force(start, end, previous)

    def again(self, turned: Array) -> Array:
        """Never asked for: its attitude is known."""
        raise NotImplementedError

    def accept(self, moment: Callable[[], Array], body_force: Array, turned: Array) -> Array:
        """What it was."""
        del moment, turned
        return body_force

    def acceleration(self, start: float, end: float) -> Array:
        """That of the frame."""
        return self.frame.acceleration(start, end)

    def working_acceleration(self, start: float, end: float) -> Array:
        """That of the frame."""
        return self.frame.working_acceleration(start, end)

    def displacement(self, time: float) -> Array:
        """That of the frame."""
        return self.frame.displacement(time)

    def attitude(self, time: float) -> Array | None:
        """That of the frame."""
        return None if self.frame.turning is None else self.frame.attitude(time)

    def rate(self, time: float) -> Array:
        """That of the frame."""
        return self.frame.rate(time)

    def metrics(self) -> dict[str, float]:
        """None: the motion is known."""
        return {}

    def save(self) -> dict[str, Array]:
        """Nothing: it is a function of time."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Nothing."""
