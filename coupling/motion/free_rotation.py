"""How a free tank turns: its attitude, and what but its contents turns it.

Of the tank alone, S = int x x^T dm in its own axes, a point at x stands at R x and moves by R' x:
the time scheme is that of the sheet's nodes (``cloth.kinematics``), for the matrix R in place of
positions, so that tank and sheet turn as one body where they are one. Springs, dampers and moments
are about the ground's axes. What the contents do stands in the sheet's own step (``cloth.rotor``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial.transform import Rotation

from cloth.kinematics import Kinematics, kinematics
from cloth.rotation import axial, cross_matrix, rotation_matrix
from coupling.motion.table import TableMotion
from coupling.ports import Array, Rotor, RunFailed, Turn
from coupling.scene.carrier import Carrier

_SMALL = 1e-4  # rad, below which 1/12 is the factor of the Jacobian's square to rounding
# Committed, beside R and R' (3, 3): moments (3,) [N m] on the tank of all but its contents, and on
# the contents, its angular velocity (3,) [rad/s], all in the ground's axes; energies [J].
_VECTORS = ("support", "given", "rate", "work", "damped", "contents")


@dataclass(frozen=True, kw_only=True)
class _Part:
    """A part of a step that is open: from ``start`` to ``end`` [s], by ``kin`` of R (3, 3).

    ``presumed`` (3, 3): its attitude at the end; ``pushed`` (3,) [N m]: the given moment.
    """

    start: float
    end: float
    kin: Kinematics
    presumed: Array
    pushed: Array

    def rate(self, attitude: Array) -> Array:
        """Angular velocity (3,) [rad/s] at the end in an ``attitude`` (3, 3), in its axes."""
        return _skew(attitude.T @ self.kin.velocity(attitude))


class FreeRotation:
    """Turns as it is pushed. ``section``: its inertia, springs, dampers and moments."""

    def __init__(self, section: Carrier) -> None:
        inertia = np.array(section.inertia)
        self._second = np.diag(0.5 * inertia.sum() - inertia)  # S
        self._springs = np.array(section.rotational_springs)
        self._dampers = np.array(section.rotational_dampers)
        self._moments = None if section.moments is None else TableMotion(section.moments)
        none = np.zeros((3, 3))
        self._now: dict[str, Array] = {
            "attitude": np.eye(3), "spin": none, "previous_attitude": np.eye(3),
            "previous_spin": none, "previous_dt": np.zeros(1), "held": np.zeros(3),
        } | {name: np.zeros(3) for name in _VECTORS}  # fmt: skip
        self._part: _Part | None = None

    def start(self, weight_moment: Array) -> None:
        """At rest, the contents' weight having a ``weight_moment`` (3,) [N m] about the origin."""
        self._now["held"] = self._now["support"] = -weight_moment
        self._now["given"] = weight_moment

    def open(self, start: float, end: float, previous: float) -> None:
        """Open a part of a step from ``start`` to ``end`` [s], in the attitude without a moment."""
        now = self._now
        kin = kinematics(
            end - start, float(now["previous_dt"][0]), now["attitude"], now["spin"],
            now["previous_attitude"], now["previous_spin"],
        )  # fmt: skip
        pushed = np.zeros(3)
        if self._moments is not None:
            pushed = self._moments.step_acceleration(start, end, previous)
        presumed = Rotation.from_matrix(kin.prediction).as_matrix()
        self._part = _Part(start=start, end=end, kin=kin, presumed=presumed, pushed=pushed)

    def presume(self, turned: Array) -> None:
        """Presume an attitude that is ``turned`` (3,) [rad] further, in the axes of the last."""
        part = self._opened
        further = Rotation.from_matrix(part.presumed @ rotation_matrix(turned)).as_matrix()
        self._part = replace(part, presumed=further)

    @property
    def _opened(self) -> _Part:
        assert self._part is not None, "open comes first"
        return self._part

    @property
    def presumed(self) -> Array:
        """Attitude (3, 3) that the open part presumes at its end."""
        return self._opened.presumed

    def turn(self) -> Turn:
        """How the tank turns in the open part, as presumed."""
        part, now = self._opened, self._now
        ground = part.presumed
        angular = (ground - part.kin.prediction) / part.kin.b**2  # R''
        return Turn(
            attitude=ground, last=ground.T @ now["attitude"],
            before=ground.T @ now["previous_attitude"], rate=part.rate(ground),
            acceleration=_skew(ground.T @ angular),
        )  # fmt: skip

    def rotor(self) -> Rotor:
        """What the sheet's step is to know of it."""
        part, ground = self._opened, self._opened.presumed
        stiff = np.diag(self._springs + self._dampers / part.kin.b)
        torque = self._support(ground, part.rate(ground)) + part.pushed
        return Rotor(
            history=ground.T @ part.kin.prediction @ self._second,
            torque=ground.T @ torque,
            stiffness=ground.T @ stiff @ ground,
        )

    def _support(self, attitude: Array, rate: Array) -> Array:
        """Moment (3,) [N m] of what holds the tank, in the ground's axes; ``rate`` in its own."""
        turned = Rotation.from_matrix(attitude).as_rotvec()
        springs = _potential_moment(turned, self._springs)
        return np.asarray(self._now["held"] + springs - self._dampers * (attitude @ rate))

    def accept(self, turned: Array) -> Array:
        """Commit the open part, which ends ``turned`` (3,) [rad] beyond what it presumes.

        Returns the attitude (3, 3).
        """
        self.presume(turned)
        part, now = self._opened, self._now
        ground, kin, dt = part.presumed, part.kin, part.end - part.start
        self._refuse_half_turn(ground)
        rate = ground @ part.rate(ground)
        support = self._support(ground, part.rate(ground))
        taken = -axial(ground.T @ kin.prediction @ self._second) / kin.b**2
        given = support + part.pushed - ground @ taken
        slip = 0.5 * dt * self._dampers * (now["rate"] ** 2 + rate**2)
        mean = 0.5 * dt * (now["rate"] + rate)
        pushed = part.pushed
        if self._moments is not None:
            pushed = self._moments.working_acceleration(part.start, part.end)
        self._now = now | {
            "attitude": ground, "spin": kin.velocity(ground),
            "previous_attitude": now["attitude"], "previous_spin": now["spin"],
            "previous_dt": np.array([dt]), "support": support, "given": given, "rate": rate,
            "work": now["work"] + (now["held"] + pushed) * mean,
            "damped": now["damped"] + slip,
            "contents": now["contents"] + 0.5 * dt * (now["given"] * now["rate"] + given * rate),
        }  # fmt: skip
        return ground

    def _refuse_half_turn(self, ground: Array) -> None:
        """Raise ``RunFailed`` where springs would hold a tank from the other side."""
        before, after = (
            Rotation.from_matrix(one).as_rotvec() for one in (self._now["attitude"], ground)
        )
        if self._springs.any() and float(before @ after) < 0.0 and after @ after > 0.25 * np.pi**2:
            raise RunFailed(
                f"t = {self._opened.end:.6g} s: the tank has turned by half a revolution, past "
                "which its rotational springs pull it on. Make them stiffer, or leave "
                "carrier.rotational_springs out."
            )

    @property
    def attitude(self) -> Array:
        """R (3, 3): v in the tank's axes is R v in the ground's."""
        return self._now["attitude"]

    @property
    def rate(self) -> Array:
        """Angular velocity (3,) [rad/s], in the tank's own axes."""
        return np.asarray(self._now["rate"] @ self._now["attitude"])

    def metrics(self) -> dict[str, float]:
        """Moment of what holds the tank [N m] by axis; energies [J] as ``FreeTank`` has them."""
        now = self._now
        spin, turned = now["spin"], Rotation.from_matrix(now["attitude"]).as_rotvec()
        axes = zip("xyz", now["support"], strict=True)
        return {f"support_moment_{axis}": float(moment) for axis, moment in axes} | {
            "carrier_kinetic_energy": 0.5 * float(np.trace(spin @ self._second @ spin.T)),
            "spring_energy": 0.5 * float(self._springs @ turned**2),
            "carrier_work": float(now["work"].sum()),
            "damper_loss": float(now["damped"].sum()),
            "contents_work": float(now["contents"].sum()),
        }

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""
        return {f"rotation_{name}": value for name, value in self._now.items()}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""
        self._now = {name: saved[f"rotation_{name}"] for name in self._now}


def _potential_moment(turned: Array, springs: Array) -> Array:
    """Moment (3,) [N m] of the energy turned . K turned/2 at a rotation vector ``turned`` (3,).

    The angular velocity in the ground's axes is J d(turned)/dt with the left Jacobian J of the
    rotations (Sola et al., A micro Lie theory, 2018, eq. 146), so that it is -J^-T K turned: that
    of unequal ``springs`` K (3,) [N m/rad] is -K turned only where the tank hardly turns.
    """
    cross, angle = cross_matrix(turned), float(np.linalg.norm(turned))
    curved = 1.0 / 12.0
    if angle > _SMALL:
        curved = (1.0 - 0.5 * angle / np.tan(0.5 * angle)) / angle**2
    inverse = np.eye(3) + 0.5 * cross + curved * cross @ cross
    return np.asarray(-inverse @ (springs * turned))


def _skew(matrix: Array) -> Array:
    """Vector (3,) of the skew part of a ``matrix`` (3, 3): of [w] it is w."""
    return np.asarray(0.5 * axial(matrix))
