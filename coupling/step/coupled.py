"""One coupled step: structure and flow solved in turn until they agree on the interface."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
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
from coupling.step.convergence import Convergence
from coupling.step.divergence import diverged, told_from_divergence
from coupling.step.interface_problem import InterfaceProblem
from coupling.step.nearest import nearest
from coupling.step.surrogate import surrogate_iterate

DIVERGED = 1e3  # residual over the step's displacement: no scheme comes back from there
SLOW, MAPS = 8, 3  # iterations on a map before its rate is judged; maps of a step, at most
RATE = 0.3  # of the residual: what an iteration with the added mass should leave

_log = logging.getLogger(__name__)


class CoupledStep:
    """Couples ``structure`` and ``flow`` through ``mapping`` by ``scheme``.

    ``record`` is told of every iteration: time [s], iteration, relative residual, seconds.

    With ``added_mass`` (see ``InterfaceProblem``) slams are met in three ways. The map is that of
    where the diaphragm is heading: where it does not come to be there, the map leads astray, and is
    made anew for where it has come to. The liquid's inertia, held during the step, changes with the
    shape: where iterations are slow, the next iterate is sought with its change as a surrogate. And
    an iterate that leads nowhere is drawn back towards the last. Other schemes stay as they are.
    """

    def __init__(
        self,
        structure: Structure,
        flow: Flow,
        mapping: InterfaceMap,
        scheme: Scheme,
        *,
        added_mass: bool,
        convergence: Convergence,
        max_iterations: int,
        record: Callable[[float, int, float, float], None],
    ) -> None:
        self.problem = InterfaceProblem(structure, flow, mapping, added_mass=added_mass)
        self.scheme = scheme
        self.convergence = convergence
        self.max_iterations = max_iterations
        self.record = record
        self._tried, self._parts = 0, list[tuple[float, FlowSample]]()  # since the last report

    @property
    def wall(self) -> dict[str, float]:
        """Seconds spent in "structure", "fluid" and "mapping"."""
        return self.problem.wall

    def advance(self, time: float, dt: float, load: HydrostaticLoad) -> StepReport:
        """Solve and commit the step from ``time`` to ``time + dt`` [s] under ``load``, in one."""
        self.attempt(time, dt, load)
        self.accept()
        return self.report()

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]. Raises ``StepFailed``, ArithmeticError.

        Iterations that end before they have converged are no failure; ``report`` says so.
        """
        scheme = self.scheme.save()
        try:
            self._solve(time, dt, load)
        except (StepFailed, ArithmeticError):
            self.problem.abandon()
            self.scheme.restore(scheme)
            raise
        return True

    def _solve(self, time: float, dt: float, load: HydrostaticLoad) -> None:
        clock, problem = perf_counter(), self.problem
        x, residuals = problem.begin_step(time, dt, load), list[float]()
        solved = self._begin_map()
        made, maps = 0, 1
        for iteration in range(1, self.max_iterations + 1):
            self._tried += 1
            with told_from_divergence(time + dt, residuals):
                x, image = self._solved(x, solved)
            solved = x
            relative = self.convergence.relative(image - x, x - problem.start, dt)
            residuals.append(relative)
            self.record(time + dt, iteration, relative, perf_counter() - clock)
            clock = perf_counter()
            self._last, self._residual = (x, image - x), relative
            if relative <= self.convergence.tolerance or iteration == self.max_iterations:
                return
            since = residuals[made:]
            astray = not relative < DIVERGED
            astray |= len(since) > SLOW and self.convergence.is_far(since)
            if astray and problem.added_mass and problem.moves and maps < MAPS:
                x = problem.remap()
                solved = self._begin_map()
                made, maps = iteration, maps + 1
                continue
            if not relative < DIVERGED:
                raise diverged(time + dt, residuals)
            x = self._next(x, image, since)

    def _begin_map(self) -> Array:
        """Forget what holds on one map only; where the interface (p, 3) [m] starts on this one."""
        self.scheme.begin_step()
        self._by_surrogate, self._trusted = False, True
        return self.problem.start

    def _solved(self, x: Array, before: Array) -> tuple[Array, Array]:
        """The interface ``x`` (p, 3) [m], its volume closed, and its image.

        With the added mass an ``x`` for which there is no mesh, or whose pressure the structure
        cannot bear, is drawn back towards the interface solved ``before`` (p, 3) [m].
        """

        def ask(points: Array) -> tuple[Array, Array]:
            points = self.problem.close_volume(points)
            return points, self.problem.image(points)

        return nearest(ask, x, before) if self.problem.added_mass else ask(x)

    def _next(self, x: Array, image: Array, since: list[float]) -> Array:
        """The iterate (p, 3) [m] after ``x``, which has led to ``image``.

        ``since``: relative residuals on this map. The surrogate takes over from the scheme where
        two iterations have left more than they should. Once it does no better it is let be.
        """
        update = self.scheme.update(x.ravel(), (image - x).ravel()).reshape(x.shape)
        if self._by_surrogate:
            self._trusted = since[-1] <= RATE * since[-2]
        slow = len(since) > 2 and since[-1] > RATE**2 * since[-3]
        if not (self.problem.added_mass and self._trusted and (self._by_surrogate or slow)):
            self._by_surrogate = False
            return update
        found: Array | None = None
        tolerance = RATE * self.convergence.tolerance / since[-1]
        try:
            found = surrogate_iterate(self.problem, x, image, update, tolerance=tolerance)
        except (StepFailed, ArithmeticError) as failure:
            _log.info("the surrogate is let be: %s", failure)
        self._by_surrogate = self._trusted = found is not None
        return update if found is None else found

    def accept(self) -> None:
        """Commit the last attempt."""
        x, residual = self._last
        self.scheme.accept_step(x.ravel(), residual.ravel())
        self._parts.append((self._residual, self.problem.accept_step()))

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
