"""The inner iteration of a step: ADMM with all forces re-evaluated on the current iterate."""

from __future__ import annotations

import math

import numpy as np

from cloth import node_kernels, triangle_kernels
from cloth.arrays import Array
from cloth.contact import stuck
from cloth.ending import Bounds, VolumeLostError, ending
from cloth.problem import Solution, StepProblem
from cloth.recoil import turned_in
from cloth.self_contact.planes import Planes

RESPONSE_EVERY = 5  # iterations between two of the volume's answers to the datum
CONTACT_EVERY = 10  # iterations between two looks at what touches
CONTACT_AFTER = 20  # iterations before the first
LEAST = 10  # iterations before the first look at what they leave
SPAN = 5  # iterations over which their contraction is measured
STEPS = 20.0  # times the tolerance: the error of a step, over what the step moves
MARGIN = 0.2  # of a step's first solve: further iterations, which its later solves may need too
CONTRACTION = (0.5, 0.98)  # bounds: a lucky pair of iterations does not end a solve
# Iterations in which the slowest contraction divides moves by e^2: without any gain, none comes.
PATIENCE = round(2.0 / (1.0 - CONTRACTION[1]))


class Iteration:
    """One solve in progress: the iterate ``x`` (n, 3) and the duals of both constraints."""

    def __init__(self, problem: StepProblem, force: Array, planes: Planes | None) -> None:
        p, model = problem, problem.model
        self.problem, self.planes = p, planes
        self.penalty = np.full(len(model.triangles), p.penalty)
        self.tensile, self.compressive = model.stiffness(p.settings, p.dt)
        self.weight = model.shell_penalty(p.settings, p.penalty)
        self.damped = model.bending.moment * (1.0 + p.settings.bending_damping / p.kin.b)
        self.drag = model.mass * p.settings.drag / p.kin.b
        self.largest_force = float(np.abs(force).max())
        self.external = force
        self.force = np.where(model.free[:, None], p.constant_force + force, 0.0)
        self.x = p.start.copy()
        self.z = np.zeros_like(p.tension)
        self.u = p.tension / self.penalty[:, None, None]
        # Fixed nodes have no multiplier, but planes that part them from others see them here.
        self.zc = np.where(model.mesh.fixed[:, None], model.clamped, 0.0)
        self.uc = p.contact_force / np.where(self.weight > 0.0, self.weight, 1.0)[:, None]
        self.gradient, self.response = np.zeros_like(self.x), np.zeros_like(self.x)
        self.rub, self.self_rub = np.zeros_like(self.x), np.zeros_like(self.x)
        self.pressing = np.zeros((len(self.x), 2))
        self.slope = p.load.density * p.load.body_force
        self.datum = p.datum if p.load.datum is None else p.load.datum
        self.done = 0
        self.moves: list[float] = []  # rms displacement [m] of every iteration

    def advance(self) -> None:
        """Do one iteration: forces and constraints at the present iterate, then a linear solve."""
        p, model, bent = self.problem, self.problem.model, self.problem.model.bending
        rhs, gradient = self.force.copy(), self.gradient
        if p.recoil is not None:
            answer = p.recoil.answer(self.x, self.external)
            self.slope = p.load.density * answer.body_force
            rhs += answer.force
        r = p.settings.relaxation if self.done else 1.0
        cone = triangle_kernels.triangle_step(
            self.x, model.triangles, model.corner_starts, model.corners,
            model.gradients, model.areas, self.penalty, r, self.tensile,
            self.compressive, model.poisson, p.rest, self.z, self.u,
            self.datum, self.slope, model.free, gradient, rhs,
        )  # fmt: skip
        node_kernels.node_step(
            self.x, model.shell.profile, self.weight, r, p.settings.shell_friction, p.committed,
            self.zc, self.uc, self.rub,
            model.triangles, gradient, bent.starts, bent.columns, bent.values, bent.moment,
            self.damped, p.own.position_anchor, self.drag, rhs,
        )  # fmt: skip
        if self.planes is not None:
            self.planes.step(
                model.mobility, model.shell.profile, self.weight, p.settings.self_friction,
                p.committed, self.zc, self.uc, self.self_rub, self.pressing, rhs,
            )  # fmt: skip
        x = p.system.solve(rhs)
        x[model.mesh.fixed] = model.clamped[model.mesh.fixed]
        if p.load.volume is not None:
            x += self._correction(p.load.volume - model.below_rim - float(cone), gradient, x)
        change = (x - self.x).ravel()
        self.moves.append(math.sqrt(float(change @ change) / len(x)))
        self.x = x
        self.done += 1

    def _correction(self, missing: float, gradient: Array, x: Array) -> Array:
        """What a better datum adds to ``x`` (n, 3) [m], to meet the linearised volume.

        ``missing`` [m^3] at the iterate before. The response S^-1 grad V is of an earlier iterate:
        it scales a correction that vanishes, and the datum's whole load is in the right-hand side.
        """
        if self.done % RESPONSE_EVERY == 0:
            self.response = self.problem.system.solve(gradient)
        missing -= float(np.vdot(gradient, x - self.x))
        correction = missing / float(np.vdot(gradient, self.response))
        self.datum += correction
        return correction * self.response

    @property
    def left(self) -> float:
        """Rms displacement [m] that all further iterations would add at the present contraction."""
        if self.done <= SPAN:
            return math.inf
        least, most = CONTRACTION
        ratio = self.moves[-1] / max(self.moves[-1 - SPAN], 1e-300)
        rate = min(max(ratio ** (1.0 / SPAN), least), most)
        return float(self.moves[-1] * rate / (1.0 - rate))

    def allowed(self, x: Array) -> float:
        """Rms displacement [m] that a solve may leave which ends at ``x`` (n, 3) [m]."""
        p = self.problem
        moved = math.sqrt(float(np.sum((x - p.committed) ** 2)) / len(x))
        return p.settings.tolerance * min(p.model.size, STEPS * (moved + p.scale))

    @property
    def near_enough(self) -> bool:
        """Whether what is left is within the tolerance."""
        return self.done >= LEAST and self.left <= self.allowed(self.x)

    @property
    def stalled(self) -> bool:
        """Whether the last ``PATIENCE`` iterations have all moved more than one before them."""
        if self.problem.settings.tolerance <= 0.0 or self.done <= 2 * PATIENCE:
            return False
        return min(self.moves[-PATIENCE:]) > min(self.moves[:-PATIENCE])

    def look(self) -> None:
        """Find what touches now; it is kept apart from here on, as is what touched before.

        A pair that is let go as soon as it has parted meets again, and the iteration finds no end.
        """
        p, model = self.problem, self.problem.model
        if model.self_contact is not None and np.all(np.isfinite(self.x)):
            x = model.shell.confine(self.x)
            contact = model.self_contact.resolve(p.committed, x, model.shell)
            found = contact.planes
            if len(found.nodes):
                self.planes = found if self.planes is None else found.joined(self.planes)
            self.self_rub[:] = 0.0

    def finish(self) -> Solution:
        """Return the iterate made admissible: see ``cloth.ending``.

        Raises ArithmeticError instead of returning a position that is not finite.
        """
        p, model = self.problem, self.problem.model
        if not math.isfinite(self.moves[-1] + self.datum):
            raise self._diverged("the position is no longer finite")
        bounds = Bounds(
            model=model,
            start=p.committed,
            volume=p.load.volume,
            response=self.response,
        )
        still = stuck(p.committed, self.zc, model.shell, self.rub)[:, None]
        try:
            end = ending(np.where(still, self.zc, self.x), bounds)
        except VolumeLostError as lost:
            raise self._diverged(str(lost)) from lost
        if not np.all(np.isfinite(end.position)):
            raise self._diverged("the position is no longer finite")
        moved = math.sqrt(float(np.sum((end.position - self.x) ** 2)) / len(self.x))
        admissible = end.converged and moved <= self.allowed(end.position)
        return Solution(
            position=end.position,
            tension=self.u * self.penalty[:, None, None],
            contact_force=self.uc * self.weight[:, None],
            rub=self.rub,
            self_rub=self.self_rub,
            pressing=self._pressing(),
            datum=self.datum,
            turned=turned_in(p.recoil, end.position, self.external),
            volume=end.volume,
            strain=end.strain,
            change=self.left + moved,
            iterations=self.done,
            contact=end.contact,
            planes=self.planes,
            admissible=admissible,
            converged=admissible and self.near_enough,
        )

    def _pressing(self) -> Array:
        """As ``Solution`` has it: the planes' own, or all of the force where there are none."""
        if self.planes is not None and len(self.planes.nodes):
            return self.pressing
        normal = self.problem.model.shell.normal(self.zc)
        outward = self.weight * np.einsum("id,id->i", self.uc, normal)
        return np.column_stack([np.maximum(outward, 0.0), np.zeros_like(outward)])

    def _diverged(self, symptom: str) -> ArithmeticError:
        return ArithmeticError(
            f"cloth: the inner iteration has diverged after {self.done} iterations at a time step "
            f"of {self.problem.dt:.3g} s and nodal forces up to {self.largest_force:.3g} N: "
            f"{symptom}."
        )


@np.errstate(over="ignore", invalid="ignore")  # what diverges is found, and said, in ``finish``
def iterate(
    problem: StepProblem, force: Array, first: Solution | None, *, near: bool, alone: bool = False
) -> Solution:
    """Solve the step under nodal ``force`` (n, 3) [N].

    ``first``: the step's first solution, which decided the number of iterations and what touches;
    None: as many as it takes to converge, within the settings' bound. ``near``: whether parts of
    the sheet were near each other at the step's start, so that it pays to look while iterating.
    ``alone``: no later solve will need the margin.
    Raises ArithmeticError when the iteration diverges.
    """
    most = problem.settings.iterations
    run = Iteration(problem, force, None if first is None else first.planes)
    if first is not None:
        while run.done < first.iterations or (
            run.done < most and not run.near_enough and not run.stalled
        ):
            run.advance()
        return run.finish()
    rubs = problem.model.self_contact is not None and problem.settings.self_friction > 0.0
    while run.done < most and not (run.near_enough and not rubs) and not run.stalled:
        if (near or rubs) and run.planes is None and run.done >= CONTACT_AFTER:
            run.look()
            rubs = False
        run.advance()
    if run.near_enough and not alone:
        for _ in range(round(MARGIN * run.done)):
            run.advance()
    return _parted(run, most)


def _parted(run: Iteration, most: int) -> Solution:
    """The end of ``run`` after at most ``most`` iterations, with planes for all that touches.

    It ends without having converged once as many iterations as the run had before, and no fewer
    than ``PATIENCE``, have not halved what is left: at the slowest contraction that takes 35.
    """
    solution, patience = run.finish(), max(run.done, PATIENCE)
    best, since = solution.change, run.done
    while run.done < most and not solution.converged and run.done - since < patience:
        if not solution.admissible:
            run.look()
        for _ in range(CONTACT_EVERY):
            run.advance()
        solution = run.finish()
        if solution.change < 0.5 * best:
            best, since = solution.change, run.done
    return solution
