"""A tank that nothing but springs, dampers and given forces and moments hold.

With P = M v + dQ/dt the momentum of tank and contents, M their mass and Q the contents' first
moment in the tank's frame, Newton's law of the whole asks for

    M a + d^2 Q/dt^2 = F - K (d - s) - C (v - ds/dt),

d the tank's displacement, s the ground's. So the contents' force on the tank is that of their
momentum, not an integral of pressures: without F, K and C the momentum is kept to rounding. The
time scheme is the sheet's (``cloth.kinematics``), and a as a function of Q stands in the sheet's
own step (``cloth.recoil``). How it turns, where it is free to: ``free_rotation``. A liquid without
a flow has no momentum of its own in the tank: its pressure takes none from it, and felt by the tank
alone that would be an inertia below zero.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from cloth.kinematics import Kinematics, kinematics
from coupling.motion.frame import Frame
from coupling.motion.free_rotation import FreeRotation
from coupling.motion.table import TableMotion
from coupling.ports import Array, Recoil, Turn
from coupling.scene.carrier import Carrier

# Committed arrays, each (3,) but for the step before [s] and the energies [J] since the start.
_STATE = ("displacement", "velocity", "moment", "moment_rate")
_NAMES = (
    *_STATE, *(f"previous_{name}" for name in _STATE),
    "previous_dt", "acceleration", "first_acceleration", "time", "work", "damped", "contents",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A part of a step that is open: from ``start`` to ``end`` [s].

    ``unmoved`` (3,) [m/s^2]: a0, the tank's acceleration if the contents keep theirs in it;
    ``mass`` (3,) [kg]: of tank and contents, with springs and dampers taken into it.
    """

    start: float
    end: float
    unmoved: Array
    mass: Array
    tank: Kinematics
    moment: Kinematics


class FreeTank:
    """Moves as it is pushed; ``recoil``, ``turn``: of the part of a step that was opened last.

    ``section``: its springs, dampers and forces; ``frame``: gravity, and how the ground moves;
    ``mass`` [kg] of tank and contents; ``density`` [kg/m^3] of a liquid that has a momentum of its
    own in the tank, 0 for none; ``below_rim`` (3,) [m^4]: int x dV over the shell's inside there.
    """

    def __init__(
        self, section: Carrier, frame: Frame, *, mass: float, density: float, below_rim: Array
    ) -> None:
        self.frame, self.mass, self.density, self._below_rim = frame, mass, density, below_rim
        self.springs, self.dampers = np.array(section.springs), np.array(section.dampers)
        self.forces = None if section.forces is None else TableMotion(section.forces)
        self.rotation = None if section.inertia is None else FreeRotation(section)
        self.recoil: Recoil | None = None
        self.turn: Turn | None = None
        self._now = {name: np.zeros(3) for name in _NAMES}
        self._part: _Part | None = None

    def start(self, moment: Array, weight: Array) -> None:
        """At rest, the contents' first moment being ``moment`` (3,) [kg m], as in ``accept``.

        ``weight`` (3,) [kg m]: that of all of them.
        """
        self._now["moment"] = self._now["previous_moment"] = moment
        if self.rotation is not None:
            self.rotation.start(np.cross(weight, self.frame.gravity))

    def begin_step(self) -> None:
        """Keep the acceleration where the step begins."""
        self._now["first_acceleration"] = self._now["acceleration"]

    def body_force(self, start: float, end: float, previous: float) -> Array:
        """Open a part of a step; g - a0, a0 the acceleration if the contents keep theirs."""
        now, before = self._now, float(self._now["previous_dt"][0])
        tank, moment = (
            kinematics(
                end - start, before, now[place], now[rate],
                now[f"previous_{place}"], now[f"previous_{rate}"],
            )
            for place, rate in (("displacement", "velocity"), ("moment", "moment_rate"))
        )  # fmt: skip
        b = tank.b
        mass = self.mass + b * (self.dampers + b * self.springs)
        pushed = self._support(end, tank.prediction, tank.velocity_anchor)
        if self.forces is not None:
            pushed = pushed + self.forces.step_acceleration(start, end, previous)
        self._part = _Part(
            start=start, end=end, unmoved=pushed / mass, mass=mass, tank=tank, moment=moment
        )
        if self.rotation is not None:
            self.rotation.open(start, end, previous)
        return self._presumed()

    def again(self, turned: Array) -> Array:
        """As ``body_force``, of the part that is open, ``turned`` (3,) [rad] further at its end."""
        assert self.rotation is not None
        self.rotation.presume(turned)
        return self._presumed()

    def _presumed(self) -> Array:
        """Body force, recoil and turn of the open part in the tank's axes, as they are presumed."""
        part, ground = self._opened, np.eye(3)
        recoil = Recoil(
            compliance=np.diag(1.0 / part.mass), density=self.density,
            prediction=part.moment.prediction, below_rim=self._below_rim,
        )  # fmt: skip
        if self.rotation is not None:
            ground, self.turn = self.rotation.presumed, self.rotation.turn()
            recoil = replace(
                recoil, compliance=ground.T @ recoil.compliance @ ground,
                prediction=recoil.prediction @ ground, rotor=self.rotation.rotor(),
            )  # fmt: skip
        self.recoil = recoil
        return np.asarray((self.frame.gravity - part.unmoved) @ ground)

    @property
    def _opened(self) -> _Part:
        assert self._part is not None, "body_force comes first"
        return self._part

    def _support(self, time: float, displacement: Array, velocity: Array) -> Array:
        """Force (3,) [N] of springs and dampers, beyond what holds the tank up at rest."""
        ground = self.frame.motion
        stretched = displacement - ground.displacement(time)
        return -self.springs * stretched - self.dampers * (velocity - ground.velocity(time))

    def accept(self, moment: Callable[[], Array], body_force: Array, turned: Array) -> Array:
        """Commit the part that was opened last: Newton's law with the contents' ``moment``."""
        del body_force
        part, now, ground = self._opened, self._now, np.eye(3)
        if self.rotation is not None:
            ground = self.rotation.accept(turned)
        there = ground @ moment()
        b, dt = part.tank.b, part.end - part.start
        contents = (there - part.moment.prediction) / (b * b * part.mass)
        acceleration = part.unmoved - contents
        velocity = part.tank.velocity_anchor + b * acceleration
        after = {
            "displacement": part.tank.prediction + b * b * acceleration,
            "velocity": velocity,
            "moment": there,
            "moment_rate": part.moment.velocity(there),
        }
        self._now = (
            now
            | {f"previous_{name}": now[name] for name in _STATE}
            | after
            | {
                "previous_dt": np.full(3, dt), "time": np.full(3, part.end),
                "acceleration": acceleration,
            }
            | self._energies(part, after, acceleration)
        )  # fmt: skip
        return np.asarray((self.frame.gravity - acceleration) @ ground)

    def _energies(
        self, part: _Part, after: Mapping[str, Array], acceleration: Array
    ) -> dict[str, Array]:
        """Works [J] by axis since the start, by the trapezoidal rule.

        Of the ground and the given force, what the dampers took, and what went to the contents.
        """
        now, ground, dt = self._now, self.frame.motion, part.end - part.start
        states = ((part.start, now), (part.end, after))
        support = [self._support(t, one["displacement"], one["velocity"]) for t, one in states]
        slip = [(one["velocity"] - ground.velocity(t)) ** 2 for t, one in states]
        moved = after["displacement"] - now["displacement"]
        ground_moved = ground.displacement(part.end) - ground.displacement(part.start)
        work = 0.5 * (support[0] + support[1]) * ground_moved
        if self.forces is not None:
            work = work + self.forces.working_acceleration(part.start, part.end) * moved
        mean = 0.5 * (now["acceleration"] + acceleration)
        return {
            "work": now["work"] + work,
            "damped": now["damped"] + 0.5 * dt * self.dampers * (slip[0] + slip[1]),
            "contents": now["contents"] - mean * (after["moment"] - now["moment"]),
        }

    def acceleration(self, start: float, end: float) -> Array:
        """At the end of the last step [m/s^2]."""
        del start, end
        return self._now["acceleration"]

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean of both ends of the last step [m/s^2]: the trapezoidal rule."""
        del start, end
        return np.asarray(0.5 * (self._now["first_acceleration"] + self._now["acceleration"]))

    def displacement(self, time: float) -> Array:
        """At the end of the last step [m]."""
        del time
        return self._now["displacement"]

    def attitude(self, time: float) -> Array | None:
        """At the end of the last step, None of a tank that is held against turning."""
        del time
        return None if self.rotation is None else self.rotation.attitude

    def rate(self, time: float) -> Array:
        """At the end of the last step [rad/s]."""
        del time
        return np.zeros(3) if self.rotation is None else self.rotation.rate

    def metrics(self) -> dict[str, float]:
        """Velocity [m/s], force of the support [N] and momentum [kg m/s] by axis; energies [J].

        ``carrier_kinetic_energy`` is what tank and contents have in the ground's frame beyond the
        contents' own in the tank's, M v^2/2 + v . dQ/dt.
        """
        now, time = self._now, float(self._now["time"][0])
        velocity, displacement = now["velocity"], now["displacement"]
        support = self._support(time, displacement, velocity)
        momentum = self.mass * velocity + now["moment_rate"]
        kinetic = float(velocity @ (0.5 * self.mass * velocity + now["moment_rate"]))
        stretched = displacement - self.frame.displacement(time)
        vectors = {"tank_velocity": velocity, "support_force": support, "momentum": momentum}
        found = {
            f"{name}_{axis}": float(value)
            for name, vector in vectors.items()
            for axis, value in zip("xyz", vector, strict=True)
        }
        energies = {
            "carrier_kinetic_energy": kinetic,
            "spring_energy": 0.5 * float(self.springs @ stretched**2),
            "carrier_work": float(now["work"].sum()),
            "damper_loss": float(now["damped"].sum()),
            "contents_work": float(now["contents"].sum()),
        }
        if self.rotation is None:
            return found | energies
        turning = self.rotation.metrics()
        sums = {name: energy + turning[name] for name, energy in energies.items()}
        return found | turning | sums

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""
        return self._now | ({} if self.rotation is None else self.rotation.save())

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._now = {name: saved[name] for name in _NAMES}
        if self.rotation is not None:
            self.rotation.restore(saved)
