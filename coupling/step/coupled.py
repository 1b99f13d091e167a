"""One coupled step: structure and flow solved in turn until they agree on the interface."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from time import perf_counter

from coupling.interface.mapping import InterfaceMap
from coupling.ports import (
    Array,
    Flow,
    FlowSample,
    HydrostaticLoad,
    Scheme,
    StepFailed,
    StepReport,
    Structure,
)
from coupling.step.backtracking import Backtracking, BacktrackingSettings
from coupling.step.convergence import Convergence
from coupling.step.divergence import attributed_to_divergence, diverged_at
from coupling.step.history import History
from coupling.step.interface_problem import InterfaceProblem
from coupling.step.interface_step import Iterate, known
from coupling.step.remap import Remap, RemapSettings


@dataclass(frozen=True, kw_only=True)
class CoupledSettings:
    """Constants of a coupled step and of its policies.

    ``diverged``: residual over the step's displacement from which no scheme comes back: a guard,
    not tuned. No iteration of ``foam_cases/pad_sway_coarse`` leaves more than 0.93.
    """

    diverged: float = 1e3
    backtracking: BacktrackingSettings = field(default_factory=BacktrackingSettings)
    remap: RemapSettings = field(default_factory=RemapSettings)


_NO_POLICIES = CoupledSettings(
    backtracking=BacktrackingSettings(halvings=0), remap=RemapSettings(maps=1)
)


class CoupledStep:
    """Couples ``structure`` and ``flow`` through ``mapping`` by ``scheme``.

    In a step from t to t + dt, x being the interface at its end, S the structure's answer to a
    pressure and F the flow's to an interface:

    1. Predictor: open the step on the map for where the structure is heading; x is the structure's
       answer to the pressure carried on from the step before (``InterfaceProblem.begin_step``).
    2. Iterate: x~ = S(F(x)), r = x~ - x. Where x has no answer it goes back towards the last x that
       had one (``Backtracking``).
    3. Converged, |r| small by ``Convergence``, or ``max_iterations`` done: the step ends at x.
    4. Where the iteration stagnates or diverges on its map, go on from 1 with the map for where the
       structure has come to (``Remap``); where x diverges, the step fails and is halved
       (``Halving``).
    5. x becomes the scheme's update of (x, r). Go on from 2.

    The policies of 2 and 4 are those of a scheme with ``takes_inertia`` (see
    ``InterfaceProblem``), which needs them in slams; of other schemes a step backtracks where it is
    opened only, and iterates as their papers have it. ``record`` is called after
    every iteration with time [s], iteration, relative residual, seconds.
    """

    def __init__(
        self,
        structure: Structure,
        flow: Flow,
        mapping: InterfaceMap,
        scheme: Scheme,
        *,
        takes_inertia: bool,
        convergence: Convergence,
        max_iterations: int,
        record: Callable[[float, int, float, float], None],
        settings: CoupledSettings | None = None,
    ) -> None:
        self.settings = settings or CoupledSettings()
        self.problem = InterfaceProblem(
            structure, flow, mapping, takes_inertia=takes_inertia,
            backtracking=Backtracking(self.settings.backtracking),
        )  # fmt: skip
        policies = self.settings if takes_inertia else _NO_POLICIES
        self.backtracking = Backtracking(policies.backtracking)
        self.remap = Remap(policies.remap)
        self.scheme = scheme
        self.convergence = convergence
        self.max_iterations = max_iterations
        self.record = record
        self._last: tuple[Iterate, float] | None = None  # of the last attempt, with its residual
        self._before: Mapping[str, Array] = {}  # the scheme's memory where it began
        self._tried, self._parts = 0, list[tuple[float, FlowSample]]()  # since the last report

    def seconds(self) -> dict[str, float]:
        """Wall time since this was last asked, by part: structure, fluid, mapping."""
        return self.problem.watch.taken()

    def advance(self, time: float, dt: float, load: HydrostaticLoad) -> StepReport:
        """Solve and commit the step from ``time`` to ``time + dt`` [s] under ``load``, in one."""
        self.attempt(time, dt, load)
        self.accept()
        return self.report()

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]. Raises ``StepFailed``, ArithmeticError.

        Iterations that end before they have converged are no failure; ``report`` says so. An
        attempt before it that was not accepted is left as if it had never been.
        """
        if self._last is not None:
            self._leave()
        self._before = self.scheme.save()
        try:
            self._last = self._solve(time, dt, load)
        except (StepFailed, ArithmeticError):
            self._leave()
            raise
        return True

    def _leave(self) -> None:
        """Go back to where the attempt began."""
        self.problem.abandon()
        self.scheme.restore(self._before)
        self._last = None

    def _solve(self, time: float, dt: float, load: HydrostaticLoad) -> tuple[Iterate, float]:
        """The iterate that the step ends at, and its relative residual."""
        clock, problem, history = perf_counter(), self.problem, History()
        x = problem.begin_step(time, dt, load)
        solved = self._begin_map(history)
        for iteration in range(1, self.max_iterations + 1):
            self._tried += 1
            with attributed_to_divergence(time + dt, history.residuals):
                iterate = self.backtracking.nearest(problem.image, x, solved)
            solved = iterate.points
            relative = self.convergence.relative(iterate.residual, solved - problem.step.start, dt)
            history.add(relative)
            self.record(time + dt, iteration, relative, perf_counter() - clock)
            clock = perf_counter()
            if relative <= self.convergence.tolerance or iteration == self.max_iterations:
                break
            diverged = not relative < self.settings.diverged
            if problem.moves and self.remap.is_due(history, self.convergence, diverged=diverged):
                x = problem.remap()
                solved = self._begin_map(history)
                continue
            if diverged:
                raise diverged_at(time + dt, history.residuals)
            x = self._next(iterate)
        return iterate, relative

    def _begin_map(self, history: History) -> Array:
        """Forget what holds on one map only; where the interface (p, 3) [m] starts on this one."""
        history.begin_map()
        self.scheme.begin_step()
        return self.problem.step.start

    def _next(self, iterate: Iterate) -> Array:
        """The scheme's x (p, 3) [m] after ``iterate``."""
        x, residual = iterate.points, iterate.residual
        return self.scheme.update(x.ravel(), residual.ravel()).reshape(x.shape)

    def accept(self) -> None:
        """Commit the last attempt."""
        (iterate, residual), self._last = known(self._last), None
        self.scheme.accept_step(iterate.points.ravel(), iterate.residual.ravel())
        self._parts.append((residual, self.problem.accept_step()))

    def report(self) -> StepReport:
        """What the steps took that were accepted since the last report, as one."""
        tried, self._tried = self._tried, 0
        parts, self._parts = self._parts, []
        residual = max(residual for residual, _ in parts)
        return StepReport(
            iterations=tried,
            residual=residual,
            converged=residual <= self.convergence.tolerance,
            samples=tuple(sample for _, sample in parts),
            volume_error=max(sample.volume_error for _, sample in parts),
        )

    def save(self) -> dict[str, Array]:
        """What steps to come need of those before, but for the scheme's."""
        return self.problem.save()

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self.problem.restore(saved)
