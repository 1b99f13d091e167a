"""A tank that is free to give way to what it contains, as a part of the sheet's step.

Newton's law of a tank and its contents, of the mass M together, is in a step's implicit formula

    M (a - a0) = -(Q(x) - Q~)/b^2,

with Q the contents' first moment in the tank's frame, so that the body force g - a on sheet and
liquid is b0 + (Q - Q~)/(b^2 M), b0 = g - a0. That is a negative inertia of rank 3: what moves
against a light tank has the reduced mass of both. It stands in the step's matrix; left to the
iterations it would not converge where the tank is light. One that turns as well: ``cloth.rotor``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.linear import System
from cloth.load import Load, Recoil
from cloth.model import ClothModel


@compiled
def _cone_moment(x: Array, triangles: Ints, moment: Array) -> None:
    """Add 24 int x dV [m^4] over the cone from ``triangles`` (m, 3) to the origin to ``moment``."""
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        a0, a1, a2 = x[i, 0], x[i, 1], x[i, 2]
        b0, b1, b2 = x[j, 0], x[j, 1], x[j, 2]
        c0, c1, c2 = x[k, 0], x[k, 1], x[k, 2]
        cone = a0 * (b1 * c2 - b2 * c1) + a1 * (b2 * c0 - b0 * c2) + a2 * (b0 * c1 - b1 * c0)
        moment[0] += cone * (a0 + b0 + c0)
        moment[1] += cone * (a1 + b1 + c1)
        moment[2] += cone * (a2 + b2 + c2)


def first_moment(model: ClothModel, density: float, x: Array, below_rim: Array) -> Array:
    """Q (3,) [kg m] of the sheet at ``x`` (n, 3) [m] and a liquid of ``density`` [kg/m^3] below.

    Exact for the triangles. ``below_rim`` (3,) [m^4]: int x dV over the shell's inside there.
    """
    moment = model.mass @ x
    if density:
        cone = np.zeros(3)
        _cone_moment(x, model.triangles, cone)
        moment = moment + density * (cone / 24.0 + below_rim)
    return np.asarray(moment)


def moment_rows(model: ClothModel, density: float, x: Array) -> Array:
    """Derivative (3, n, 3) [kg] of ``first_moment`` by the nodes at ``x`` (n, 3) [m].

    Row e is the force on the nodes of the weight and the pressure of a unit body force along e;
    0 on fixed nodes.
    """
    rows = np.zeros((3, *x.shape))
    for axis in range(3):
        rows[axis, :, axis] = model.mass
    if density:
        corner = x[model.triangles]
        a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        third = density * np.cross(a, b) / 6.0
        share = 0.25 * (corner + corner.sum(axis=1, keepdims=True))  # int x phi dA over A/3
        pushed = np.einsum("tce,tx->etcx", share, third).reshape(3, -1, 3)
        nodes = model.triangles.ravel()
        for row, force in zip(rows, pushed, strict=True):
            np.add.at(row, nodes, force)
    rows[:, model.mesh.fixed] = 0.0
    return rows


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a tank does with its contents where they are.

    ``body_force`` (3,) [m/s^2]: gravity less the tank's acceleration, in its axes at the step's
    end; ``force`` (n, 3) [N]: what that, and the tank's turn, add to the step's right-hand side;
    ``turned`` (3,) [rad]: by which rotation vector the tank ends beyond what the step presumes.
    """

    body_force: Array
    force: Array
    turned: Array


class TankRecoil:
    """The body force of a step in a free tank, and what it adds to the step's matrix.

    ``push`` and ``pull`` (k, n, 3) [sqrt(N/m)]: the step's matrix is A - push^T pull, the former
    of all that the tank's motion acts on, the latter of all whose motion the tank feels.
    """

    def __init__(
        self, model: ClothModel, load: Load, recoil: Recoil, *, b: float, start: Array
    ) -> None:
        """In a step of the time ``b`` [s], whose end is looked for from ``start`` (n, 3) [m]."""
        self._model, self._load, self._recoil, self._start = model, load, recoil, start
        self._scale = recoil.compliance / b**2
        root = np.linalg.cholesky(self._scale).T
        same = recoil.density == load.density
        self._weight = moment_rows(model, load.density, start)
        self._felt = self._weight if same else moment_rows(model, recoil.density, start)
        self.push = np.einsum("jk,kix->jix", root, self._weight)
        self.pull = self.push if same else np.einsum("jk,kix->jix", root, self._felt)
        self._mass = np.where(model.free, model.mass, 0.0)

    def take_into(self, system: System) -> None:
        """Take it into the matrix A of ``system``, but for what changes a volume that is kept.

        A pressure that is the same everywhere is the datum's: forces along the volume's gradient g
        are no matter to the step. The liquid's inertia has no part in them, and what the tank takes
        of them may be more than all that A has; so rows lose what moves A^-1 g.
        """
        same = self.pull is self.push
        if self._load.volume is not None:
            _, gradient = self._model.volume_and_gradient(self._start)
            moved = system.solve(gradient)
            moved /= float(np.vdot(gradient, moved))
            self.push = _without(self.push, gradient, moved)
            self.pull = self.push if same else _without(self.pull, gradient, moved)
        system.take_recoil(self.push, self.pull)

    def answer(self, x: Array, external: Array) -> Answer:
        """Of the tank to a sheet at ``x`` (n, 3) [m], with ``external`` forces (n, 3) [N] on it."""
        del external
        recoil = self._recoil
        felt = first_moment(self._model, recoil.density, x, recoil.below_rim)
        body_force = self._load.body_force + self._scale @ (felt - recoil.prediction)
        more = self._mass[:, None] * (body_force - self._load.body_force)
        return Answer(body_force=body_force, force=more - self._linear(x), turned=np.zeros(3))

    def _linear(self, x: Array) -> Array:
        """What the matrix has of it at ``x`` (n, 3) [m]: forces (n, 3) [N]."""
        count = len(self.push)
        felt = self.pull.reshape(count, -1) @ x.ravel()
        return np.asarray(felt @ self.push.reshape(count, -1)).reshape(x.shape)


def _without(rows: Array, gradient: Array, moved: Array) -> Array:
    """Return ``rows`` (k, n, 3) less their part ``moved`` (n, 3) along the ``gradient`` (n, 3)."""
    along = rows.reshape(len(rows), -1) @ moved.ravel()
    return np.asarray(rows - along[:, None, None] * gradient)


def turned_in(recoil: TankRecoil | None, x: Array, external: Array) -> Array:
    """``Answer.turned`` (3,) [rad] of a ``recoil``, 0 of a tank that has none."""
    return np.zeros(3) if recoil is None else recoil.answer(x, external).turned
