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
from cloth.compiled import compiled
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
        liquid, spun = self._liquid_rows(rows, kin.b)
        self._stiffness = spun + rotor.stiffness
        on_free = np.where(model.free[None, :, None], liquid, 0.0)
        self._liquid, self._on_free = liquid.reshape(3, -1), on_free.reshape(3, -1)
        self._inverse = self._take_turn(start, on_free)

    def _liquid_rows(self, rows: Array | None, b: float) -> tuple[Array, Array]:
        """E^T B/b (3, n, 3) [N] and E^T E (3, 3) [N m]: the forces and moments of theta."""
        if rows is None:
            return np.zeros((3, *self._ahead.shape)), np.zeros((3, 3))
        over = rows / b
        reach = np.cross(self._ahead, over).sum(axis=1)  # E: first B (e x x^)/b
        if self._rotor.walls is not None:
            reach = reach + self._rotor.walls / b
        return np.einsum("ra,rix->aix", reach, over), reach.T @ reach

    def _take_turn(self, start: Array, on_free: Array) -> Array:
        """Take theta's answer to the sheet's motion into ``push`` and ``pull``, about ``start``.

        ``on_free`` (3, n, 3) [N]: what theta has the liquid do on free nodes. Returns the inverse
        (3, 3) of by how much theta raises the moments.
        """
        weight, base = self._moment(start), cross_matrix(self._load.body_force)
        moved, scale = cross_matrix(self._recoil.prediction), self._scale
        whole = self._history(start)
        matrix = (np.trace(whole) * np.eye(3) - whole) / self._square + self._stiffness
        # What theta adds to the body force has a moment too.
        inverse = np.linalg.inv(matrix - cross_matrix(weight) @ (base - scale @ moved))
        turn = np.stack([np.cross(axis, self._ahead) for axis in np.eye(3)])
        inertia = self._mass[:, None] * turn / self._square + on_free
        push = inertia + _mixed(base - moved @ scale, self._weight)
        pull = inertia + _mixed(base, self._weight)
        pull = _mixed(inverse, pull - _mixed(cross_matrix(weight) @ scale, self._felt))
        self.push, self.pull = np.concatenate([self.push, push]), np.concatenate([self.pull, pull])
        return np.asarray(inverse)

    def _history(self, x: Array) -> Array:
        """Sum of m x^ x^T (3, 3) [kg m^2], prediction times place, over tank and sheet."""
        return np.asarray(self._rotor.history + self._ahead.T @ (self._model.mass[:, None] * x))

    def _moment(self, x: Array) -> Array:
        """First moment (3,) [kg m] of what has weight."""
        return first_moment(self._model, self._load.density, x, self._recoil.below_rim)

    def answer(self, x: Array, external: Array) -> Answer:
        """See ``TankRecoil``; ``external`` has a moment about the origin."""
        recoil, weight = self._recoil, self._moment(x)
        felt = weight
        if recoil.density != self._load.density:
            felt = first_moment(self._model, recoil.density, x, recoil.below_rim)
        given = self._liquid @ (x - self._ahead).ravel() - self._rotor.torque
        given = given - axial(external.T @ x)
        turned, back, body_force = _found(
            self._history(x), given, weight, felt, self._square, self._stiffness, self._inverse,
            self._load.body_force, recoil.prediction, self._scale,
        )  # fmt: skip
        more = self._ahead @ (back - np.eye(3)).T / self._square
        more = more + (body_force - self._load.body_force)
        force = self._mass[:, None] * more - (turned @ self._on_free).reshape(-1, 3)
        return Answer(body_force=body_force, force=force - self._linear(x), turned=turned)


@compiled
def _found(
    history: Array,
    given: Array,
    weight: Array,
    felt: Array,
    square: float,
    stiffness: Array,
    inverse: Array,
    base: Array,
    prediction: Array,
    scale: Array,
) -> tuple[Array, Array, Array]:
    """Solve the equations of moments about the origin for theta.

    Parameters
    ----------
    history
        Sum of m x^ x^T (3, 3) [kg m^2] over tank and sheet.
    given
        Moment (3,) [N m] of the liquid's inertia without theta, less all that is given.
    weight, felt
        First moments (3,) [kg m] of what has weight, and of what the tank feels move.
    square
        b^2 [s^2].
    stiffness, inverse
        By how much theta raises ``given``, and the inverse of by how much it raises all of the
        moments, each (3, 3) [N m] and its inverse.
    base, prediction, scale
        b0 (3,) [m/s^2], Q~ (3,) [kg m] and 1/(b^2 M) (3, 3) [1/(kg s^2)].

    Returns
    -------
    turned : Array
        theta (3,) [rad].
    back : Array
        exp(-theta) (3, 3).
    body_force : Array
        Gravity less the tank's acceleration (3,) [m/s^2], in the axes found.
    """
    turned, back = np.zeros(3), np.eye(3)
    body_force = base + scale @ (felt - prediction)
    for _ in range(SOLVES):
        missing = given + stiffness @ turned - axial(back @ history) / square
        turned = turned - inverse @ (missing - cross_matrix(weight) @ body_force)
        back = rotation_matrix(-turned)
        body_force = back @ base + scale @ (felt - back @ prediction)
    return turned, back, body_force


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
