"""A free tank that also turns as it is pushed, as a part of the sheet's step.

The step is solved in the tank's axes at its end, of an attitude that it presumes; theta is the
rotation vector of what is found beyond it. In the axes found the history stands turned back,
exp(-theta) x^ in place of x^, the prediction of every point of tank and sheet alike. So the sheet's
inertia pushes with m exp(-theta) x^/b^2, and the moments about the tank's origin,

    sum over tank and sheet of m x x (x - exp(-theta) x^)/b^2 + of the liquid = N + Q x b,

with the moment N of what holds and pushes the tank and the first moment Q of all that has weight,
are three equations of theta at any x. The liquid's share follows from its inertia's rows B, turned
likewise, with C of the shell: E^T (B (x - x^)/b + E theta), E = (B (e x x^) + C)/b. How theta
answers to the sheet's motion is a negative inertia of rank 3 again.
"""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array
from cloth.kinematics import Kinematics
from cloth.load import Load, Recoil, Rotor
from cloth.model import ClothModel
from cloth.recoil import Answer, TankRecoil, first_moment
from cloth.rotation import axial, cross_matrix, rotation_matrix

SOLVES = 4  # of theta's equations, by a matrix that is off by theta: off by its fifth power then


class TurningRecoil(TankRecoil):
    """The recoil of a free tank that turns; see ``TankRecoil``."""

    def __init__(
        self,
        model: ClothModel,
        load: Load,
        recoil: Recoil,
        rotor: Rotor,
        *,
        kin: Kinematics,
        start: Array,
        rows: Array | None,
    ) -> None:
        """As of ``TankRecoil``, in a step of ``kin``, with B (r, n, 3) [kg^(1/2)] of the liquid."""
        super().__init__(model, load, recoil, b=kin.b, start=start)
        self._rotor, self._square, self._ahead = rotor, kin.b**2, kin.prediction
        spun, self._liquid = np.zeros((3, 3)), np.zeros((3, *start.shape))
        if rows is not None:
            over = rows / kin.b
            reach = np.cross(self._ahead, over).sum(axis=1)  # B (e x x^)/b
            if rotor.walls is not None:
                reach = reach + rotor.walls / kin.b
            spun, self._liquid = reach.T @ reach, np.einsum("ra,rix->aix", reach, over)
        self._stiffness = spun + rotor.stiffness
        self._on_free = np.where(model.free[None, :, None], self._liquid, 0.0)
        turn = np.stack([np.cross(axis, self._ahead) for axis in np.eye(3)])
        inertia = self._mass[:, None] * turn / self._square + self._on_free
        weight, lever = self._moment(start), cross_matrix(load.body_force)
        feels = lever - self._scale @ cross_matrix(recoil.prediction)  # of the body force
        acts = _mixed(lever - cross_matrix(recoil.prediction) @ self._scale, self._weight)
        felt = _mixed(lever, self._weight) - _mixed(cross_matrix(weight) @ self._scale, self._felt)
        whole = self._history(start)
        matrix = (np.trace(whole) * np.eye(3) - whole) / self._square + self._stiffness
        self._inverse = np.linalg.inv(matrix - cross_matrix(weight) @ feels)
        push, pull = inertia + acts, _mixed(self._inverse, inertia + felt)
        self.push, self.pull = np.concatenate([self.push, push]), np.concatenate([self.pull, pull])

    def _history(self, x: Array) -> Array:
        """Sum of m x^ x^T (3, 3) [kg m^2], prediction times place, over tank and sheet."""
        return np.asarray(self._rotor.history + self._ahead.T @ (self._model.mass[:, None] * x))

    def _moment(self, x: Array) -> Array:
        """First moment (3,) [kg m] of what has weight."""
        return first_moment(self._model, self._load.density, x, self._recoil.below_rim)

    def answer(self, x: Array, external: Array) -> Answer:
        """See ``TankRecoil``; ``external`` has a moment about the origin."""
        recoil, history, weight = self._recoil, self._history(x), self._moment(x)
        felt = weight
        if recoil.density != self._load.density:
            felt = first_moment(self._model, recoil.density, x, recoil.below_rim)
        given = np.einsum("aix,ix->a", self._liquid, x - self._ahead) - self._rotor.torque
        given = given - np.cross(x, external).sum(axis=0)
        turned, back, body_force = np.zeros(3), np.eye(3), self._body_force(felt, np.eye(3))
        for _ in range(SOLVES):
            missing = given - axial(back @ history) / self._square
            missing = missing + self._stiffness @ turned - np.cross(weight, body_force)
            turned = turned - self._inverse @ missing
            back = rotation_matrix(-turned)
            body_force = self._body_force(felt, back)
        more = self._ahead @ (back - np.eye(3)).T / self._square
        more = more + body_force - self._load.body_force
        force = self._mass[:, None] * more - np.einsum("aix,a->ix", self._on_free, turned)
        return Answer(body_force=body_force, force=force - self._linear(x), turned=turned)

    def _body_force(self, felt: Array, back: Array) -> Array:
        """Gravity less the tank's acceleration (3,) [m/s^2] in axes turned ``back`` (3, 3)."""
        moved = felt - back @ self._recoil.prediction
        return np.asarray(back @ self._load.body_force + self._scale @ moved)


def _mixed(matrix: Array, rows: Array) -> Array:
    """Return the product of a ``matrix`` (3, 3) and ``rows`` (3, n, 3)."""
    return np.asarray(np.einsum("jk,kix->jix", matrix, rows))


def recoil_of(
    model: ClothModel, load: Load, kin: Kinematics, start: Array, rows: Array | None
) -> TankRecoil | None:
    """Return the recoil of a step with this ``load``; None of a held tank.

    ``kin``: its kinematics; ``start`` (n, 3) [m]: where its end is looked for; ``rows`` (r, n, 3)
    [kg^(1/2)]: B of the liquid's inertia, None without one.
    """
    recoil = load.recoil
    if recoil is None:
        return None
    if recoil.rotor is None:
        return TankRecoil(model, load, recoil, b=kin.b, start=start)
    return TurningRecoil(model, load, recoil, recoil.rotor, kin=kin, start=start, rows=rows)
