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

VOLUME_TOLERANCE = 1e-13  # relative, aimed at
VOLUME_ALLOWED = 1e-8  # relative, above which a step counts as not converged
RESPONSE_EVERY = 4  # iterations between two of the volume's answers to the datum
STRAIN_MARGIN = 0.8  # of the limit, from where on a triangle is drawn together
SWEEPS = 50  # at most


@dataclass(frozen=True, kw_only=True)
class StepProblem:
    """What is held during a step. ``constant_force`` (n, 3) [N] does not depend on the iterate.

    ``start`` (n, 3) [m] and ``datum`` [Pa] are where the iteration sets out.
    """

    model: ClothModel
    settings: Settings
    system: System
    dt: float
    kin: Kinematics
    load: Load
    start: Array
    datum: float
    tension: Array
    contact_force: Array
    constant_force: Array
    limit: Array
    strain_limit: float


@dataclass(kw_only=True)
class Solution:
    """The end of a step: see ``cloth.state`` for the names; ``iterations`` done.

    ``converged``: the strain limit and the volume are kept.
    """

    position: Array
    tension: Array
    contact_force: Array
    datum: float
    volume: float
    strain: Array
    change: float
    iterations: int
    converged: bool


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
    damping = -settings.bending_damping / b * model.bending_force(anchor)
    total = inertial + drag + damping + system.lift(model.clamped, model.mesh.fixed)
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
        self.moment = model.bending.moment * (1.0 + p.settings.bending_damping / p.kin.b)
        self.drag = model.mass * p.settings.drag / p.kin.b
        self.largest_force = float(np.abs(force).max())
        self.force = np.where(model.free[:, None], p.constant_force + force, 0.0)
        self.x = p.start.copy()
        self.z = np.zeros_like(p.tension)
        self.u = p.tension / self.penalty[:, None, None]
        self.zc = np.zeros_like(self.x)
        self.uc = p.contact_force / np.where(self.weight > 0.0, self.weight, 1.0)[:, None]
        self.response = np.zeros_like(self.x)
        self.datum = p.datum if p.load.datum is None else p.load.datum
        self.change, self.done = 0.0, 0

    def advance(self) -> None:
        """One iteration."""
        p, model, bent = self.problem, self.problem.model, self.problem.model.bending
        rhs = self.force.copy()
        gradient, hydrostatic = np.empty_like(rhs), np.empty_like(rhs)
        r = p.settings.relaxation if self.done else 1.0
        kernels.membrane_step(
            self.x, model.triangles, model.gradients, model.areas, self.penalty, r,
            model.tensile, model.compressive, model.poisson, self.z, self.u, rhs,
        )  # fmt: skip
        kernels.contact_step(self.x, p.limit, self.weight, r, self.zc, self.uc, rhs)
        slope = p.load.density * p.load.body_force
        cone = kernels.volume_and_loads(
            self.x, model.triangles, slope, model.free, gradient, hydrostatic
        )
        rhs += hydrostatic
        rhs += self.datum * gradient
        kernels.bending_rest_step(
            gradient, bent.starts, bent.columns, bent.values, self.moment, rhs
        )
        kernels.normal_drag_step(self.x, p.kin.position_anchor, gradient, self.drag, rhs)
        x = p.system.solve(rhs)
        x[model.mesh.fixed] = model.clamped[model.mesh.fixed]
        if p.load.volume is not None:
            x += self._correction(p.load.volume - model.half_shell - float(cone), gradient, x)
        self.change = float(np.sqrt(np.mean((x - self.x) ** 2) * 3.0))
        self.x = x
        self.done += 1

    def _correction(self, missing: float, gradient: Array, x: Array) -> Array:
        """What a better datum adds to ``x`` (n, 3) [m], to meet the linearised volume.

        ``missing`` [m^3] at the iterate before. The response S^-1 grad V is of an earlier iterate:
        it scales a correction that vanishes, and the datum's whole load is in the right-hand side.
        """
        if self.done <= 1 or self.done % RESPONSE_EVERY == 0:
            self.response = self.problem.system.solve(gradient)
        missing -= float(np.vdot(gradient, x - self.x))
        correction = missing / float(np.vdot(gradient, self.response))
        self.datum += correction
        return correction * self.response

    def finish(self) -> Solution:
        """The iterate inside the shell, with its exact volume, drawn together where too long.

        Raises ArithmeticError instead of returning a position that is not finite.
        """
        p, model = self.problem, self.problem.model
        if not math.isfinite(self.change + self.datum):
            raise self._diverged("the position is no longer finite")
        x = self._closed(clamp_to_shell(self.x, p.limit))
        strain = np.empty(len(model.triangles))
        kernels.principal_strains(x, model.triangles, model.gradients, strain)
        if not model.elastic and strain.max() > STRAIN_MARGIN * p.strain_limit:
            x = self._closed(self._shortened(x))
            kernels.principal_strains(x, model.triangles, model.gradients, strain)
        if not np.all(np.isfinite(x)):
            raise self._diverged("the position is no longer finite")
        volume, wanted = model.volume(x), p.load.volume
        drift = 0.0 if wanted is None else abs(volume / wanted - 1.0)
        short = model.elastic or float(strain.max()) <= p.strain_limit
        return Solution(
            position=x,
            tension=self.u * self.penalty[:, None, None],
            contact_force=self.uc * self.weight[:, None],
            datum=self.datum,
            volume=volume,
            strain=strain,
            change=self.change,
            iterations=self.done,
            converged=short and drift <= VOLUME_ALLOWED,
        )

    def _shortened(self, x: Array) -> Array:
        """``x`` with the few triangles that still exceed the strain limit drawn together."""
        p, model = self.problem, self.problem.model
        mobility = np.where(model.free, 1.0 / model.mass, 0.0)
        for _ in range(SWEEPS):
            worst = kernels.shorten_step(
                x, model.triangles, model.gradients, mobility, STRAIN_MARGIN * p.strain_limit
            )
            if worst <= 0.1 * p.strain_limit:
                break
            x = clamp_to_shell(x, p.limit)
        return x

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
            direction = np.where(off[:, None], self.response, 0.0)
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

    ``count`` iterations; None: as many as it takes to converge, within the settings' bounds.
    Raises ArithmeticError when the iteration diverges.
    """
    settings, run = problem.settings, Iteration(problem, force)
    for _ in range(settings.iterations if count is None else count):
        run.advance()
    solution = run.finish()
    while count is None and run.done < settings.iterations_max and not solution.converged:
        run.advance()
        solution = run.finish()
    return solution
