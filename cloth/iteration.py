"""The inner iteration of a step: ADMM with all forces re-evaluated on the current iterate."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cloth import kernels
from cloth.arrays import Array
from cloth.contact import clamp_to_shell
from cloth.inertia import Kinematics
from cloth.linear import System
from cloth.load import Load, Settings
from cloth.model import ClothModel

VOLUME_TOLERANCE = 1e-13
STRAIN_MARGIN = 0.8  # the first solve aims below the limit, so that its successors stay below too


@dataclass(frozen=True, kw_only=True)
class StepProblem:
    """What is held during a step. ``constant_force`` (n, 3) [N] does not depend on the iterate."""

    model: ClothModel
    settings: Settings
    system: System
    dt: float
    kin: Kinematics
    load: Load
    start: Array
    tension: Array
    contact_force: Array
    constant_force: Array
    limit: Array
    strain_limit: float


@dataclass(kw_only=True)
class Solution:
    """The end of a step: see ``cloth.state`` for the names; ``iterations`` done."""

    position: Array
    tension: Array
    contact_force: Array
    datum: float
    volume: float
    strain: Array
    change: float
    iterations: int


def constant_force(
    model: ClothModel,
    settings: Settings,
    system: System,
    kin: Kinematics,
    body_force: Array,
    rows: Array | None,
) -> Array:
    """Inertia, weight, damping and rim (n, 3) [N]; ``rows`` (r, n, 3) [sqrt(N/m)] are B/b.

    The damping is tau_b times the rate of the whole bending force, the moulded curvature's part
    included: Q alone would damp the rotation of a curved sheet that does not bend.
    """
    b, anchor = kin.b, kin.position_anchor
    inertial = model.mass[:, None] * (kin.prediction / b**2 + body_force)
    drag = (settings.drag / b * model.mass)[:, None] * anchor
    damping = settings.bending_damping / b * (model.bending @ anchor)
    kernels.bending_rest_step(
        anchor, model.hinges.nodes, model.hinges.coefficients,
        -settings.bending_damping / b * model.moment, damping,
    )  # fmt: skip
    total = inertial + drag + damping + system.lift(model.mesh.points, model.mesh.fixed)
    if rows is not None:
        flat = rows.reshape(len(rows), -1)
        total = total + (flat.T @ (flat @ kin.prediction.ravel())).reshape(-1, 3)
    total[model.mesh.fixed] = 0.0
    return np.asarray(total)


class Iteration:
    """One solve in progress: the iterate ``x`` (n, 3) and the duals of both constraints."""

    def __init__(self, problem: StepProblem, force: Array) -> None:
        p, model = problem, problem.model
        self.problem = p
        self.penalty = model.penalty(p.settings)
        self.weight = model.contact_weight(p.settings, p.kin.b)
        self.moment = model.moment * (1.0 + p.settings.bending_damping / p.kin.b)
        self.drag = model.mass * p.settings.drag / p.kin.b
        self.largest_force = float(np.abs(force).max())
        self.force = np.where(model.free[:, None], p.constant_force + force, 0.0)
        self.x = p.start.copy()
        self.z = np.zeros_like(p.tension)
        self.u = p.tension / self.penalty[:, None, None]
        self.zc = np.zeros_like(self.x)
        self.uc = p.contact_force / np.where(self.weight > 0.0, self.weight, 1.0)[:, None]
        self.direction = np.zeros_like(self.x)
        self.datum, self.change, self.done = 0.0, 0.0, 0

    def advance(self) -> None:
        """One iteration."""
        p, model = self.problem, self.problem.model
        rhs = self.force.copy()
        gradient, hydrostatic = np.empty_like(rhs), np.empty_like(rhs)
        r = p.settings.relaxation if self.done else 1.0
        kernels.membrane_step(
            self.x, model.triangles, model.gradients, model.areas, self.penalty, r,
            model.tensile, model.compressive, self.z, self.u, rhs,
        )  # fmt: skip
        kernels.contact_step(self.x, p.limit, self.weight, r, self.zc, self.uc, rhs)
        slope = p.load.density * p.load.body_force
        cone = kernels.volume_and_loads(
            self.x, model.triangles, slope, model.free, gradient, hydrostatic
        )
        rhs += hydrostatic
        kernels.bending_rest_step(
            self.x, model.hinges.nodes, model.hinges.coefficients, self.moment, rhs
        )
        kernels.normal_drag_step(self.x, p.kin.position_anchor, gradient, self.drag, rhs)
        loose, self.direction = p.system.solve_pair(rhs, gradient)
        loose[model.mesh.fixed] = model.mesh.points[model.mesh.fixed]
        self.datum = self._multiplier(model.half_shell + cone, gradient, loose)
        x = loose + self.datum * self.direction
        self.change = float(np.sqrt(np.mean((x - self.x) ** 2) * 3.0))
        self.x = x
        self.done += 1

    def _multiplier(self, volume: float, gradient: Array, loose: Array) -> float:
        """The datum [Pa] that meets the linearised volume, or the one that is given."""
        target, given = self.problem.load.volume, self.problem.load.datum
        if target is None:
            assert given is not None
            return given
        missing = target - volume - float(np.sum(gradient * (loose - self.x)))
        return missing / float(np.sum(gradient * self.direction))

    def finish(self) -> Solution:
        """The iterate inside the shell and with its exact volume.

        Raises ArithmeticError instead of returning a position that is not finite.
        """
        p, model = self.problem, self.problem.model
        if not math.isfinite(self.change + self.datum):
            raise self._diverged("the position is no longer finite")
        x = self._closed(clamp_to_shell(self.x, p.limit))
        if not np.all(np.isfinite(x)):
            raise self._diverged("the position is no longer finite")
        strain = np.empty(len(model.triangles))
        kernels.principal_strains(x, model.triangles, model.gradients, strain)
        return Solution(
            position=x,
            tension=self.u * self.penalty[:, None, None],
            contact_force=self.uc * self.weight[:, None],
            datum=self.datum,
            volume=model.volume(x),
            strain=strain,
            change=self.change,
            iterations=self.done,
        )

    def _closed(self, x: Array) -> Array:
        """``x`` moved along the datum's own response, off the shell only, to the exact volume."""
        p, model = self.problem, self.problem.model
        if p.load.volume is None:
            return x
        for _ in range(8):
            volume, gradient = model.volume_and_gradient(x)
            if abs(volume - p.load.volume) <= VOLUME_TOLERANCE * p.load.volume:
                break
            off = np.linalg.norm(x, axis=1) < p.limit * (1.0 - 1e-9)
            direction = np.where(off[:, None], self.direction, 0.0)
            slope = float(np.sum(gradient * direction))
            if not slope > 0.0:
                raise self._diverged("the volume no longer answers to the pressure")
            x = clamp_to_shell(x + (p.load.volume - volume) / slope * direction, p.limit)
        return x

    def _diverged(self, symptom: str) -> ArithmeticError:
        return ArithmeticError(
            f"cloth: the inner iteration has diverged after {self.done} iterations at a time step "
            f"of {self.problem.dt:.3g} s and nodal forces up to {self.largest_force:.3g} N: "
            f"{symptom}. Halve time.step, or check the force: the coupling may have diverged first."
        )


def iterate(problem: StepProblem, force: Array, count: int | None) -> Solution:
    """Solve the step under nodal ``force`` (n, 3) [N].

    ``count`` iterations; None: as many as the strain limit asks for, within the settings' bounds.
    Raises ArithmeticError when the iteration diverges.
    """
    settings, run = problem.settings, Iteration(problem, force)
    least = settings.iterations if count is None else count
    for _ in range(least):
        run.advance()
    solution = run.finish()
    if count is not None:
        return solution
    target = STRAIN_MARGIN * problem.strain_limit
    while solution.strain.max() > target and run.done < settings.iterations_max:
        run.advance()
        solution = run.finish()
    return solution
