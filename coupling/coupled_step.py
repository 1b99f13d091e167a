"""One coupled step: structure and flow solved in turn until they agree on the interface."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from coupling.convergence import Convergence
from coupling.interface import pressure_force
from coupling.mapping import Matching, MovingLeastSquares
from coupling.ports import Array, Flow, FlowSample, HydrostaticLoad, RunFailed, Scheme, Structure

DIVERGED = 1e3  # residual over the step's displacement: no scheme comes back from there
_HISTORY = 3  # steps the predictor extrapolates
_EXTRAPOLATION = {0: (), 1: (1.0,), 2: (2.0, -1.0), 3: (3.0, -3.0, 1.0)}


@dataclass(frozen=True, kw_only=True)
class StepOutcome:
    """What a coupled step took; ``residual`` is relative, as ``Convergence`` has it."""

    iterations: int
    residual: float
    converged: bool
    sample: FlowSample


class CoupledStep:
    """Couples ``structure`` and ``flow`` through ``mapping`` by ``scheme``.

    With ``added_mass`` the flow's own inertia operator M_a enters the structure's step, and the
    flow hands back its defect f + M_a a only, which is small and smooth in time; its quadratic
    extrapolation from former steps is the predictor. The operator is refreshed every step, and the
    defects with it, since force and acceleration are stored apart. ``record`` is told of every
    iteration: time [s], iteration, relative residual, seconds.
    """

    def __init__(
        self,
        structure: Structure,
        flow: Flow,
        mapping: MovingLeastSquares | Matching,
        scheme: Scheme,
        *,
        added_mass: bool,
        convergence: Convergence,
        max_iterations: int,
        record: Callable[[float, int, float, float], None],
    ) -> None:
        self.structure, self.flow, self.mapping, self.scheme = structure, flow, mapping, scheme
        self.added_mass = added_mass
        self.convergence = convergence
        self.max_iterations = max_iterations
        self.record = record
        self.wall = {"structure": 0.0, "fluid": 0.0, "mapping": 0.0}
        self._force: list[Array] = []  # of the flow on its points, newest first [N]
        self._acceleration: list[Array] = []  # of the flow's points, newest first [m/s^2]
        self._previous: Array | None = None  # the flow's points one step ago

    def advance(self, time: float, dt: float, load: HydrostaticLoad) -> StepOutcome:
        """Solve and commit the step from ``time`` to ``time + dt`` [s] under ``load``."""
        start = self.flow.points
        x = self._begin(time, dt, load)
        residuals: list[float] = []
        for iteration in range(1, self.max_iterations + 1):
            clock = perf_counter()
            with _told_from_divergence(time + dt, residuals):
                with self._timed("fluid"):
                    pressure = self.flow.solve(x)
                force = pressure_force(x, self.flow.faces, pressure)
                acceleration = (x - self._inertial) / self.structure.acceleration_scale
                nodal = self.mapping.to_cloth(force + self._inertia(acceleration))
                image = self._structure_answer(nodal)
            relative = self.convergence.relative(image - x, x - start)
            residuals.append(relative)
            self.record(time + dt, iteration, relative, perf_counter() - clock)
            converged = relative <= self.convergence.tolerance
            if converged or iteration == self.max_iterations:
                break
            if not relative < DIVERGED:
                raise _diverged(time + dt, residuals)
            update = self.scheme.update(x.ravel(), (image - x).ravel()).reshape(x.shape)
            with self._timed("mapping"):
                x = self.flow.close_volume(update)
        self._force = [force, *self._force][:_HISTORY]
        self._acceleration = [acceleration, *self._acceleration][:_HISTORY]
        self._previous = start
        self.scheme.accept_step()
        self.structure.accept_step()
        return StepOutcome(
            iterations=iteration,
            residual=relative,
            converged=converged,
            sample=self.flow.accept_step(),
        )

    def _begin(self, time: float, dt: float, load: HydrostaticLoad) -> Array:
        """Open the step on both sides; the predicted interface (p, 3)."""
        self.scheme.begin_step()
        self.flow.begin_step(time, dt)
        rows = None
        if self.added_mass:
            with self._timed("fluid"):
                self._rows = self.flow.added_mass()
            with self._timed("mapping"):
                rows = self.mapping.rows_to_cloth(self._rows)
        with self._timed("structure"):
            self.structure.begin_step(dt, load, rows)
        self._inertial = self.mapping.to_flow(self.structure.inertial_prediction())
        if self.added_mass:
            past = zip(self._force, self._acceleration, strict=True)
            defects = [f + self._inertia(a) for f, a in past]
            weights = _EXTRAPOLATION[len(defects)]
            defect = sum((w * d for w, d in zip(weights, defects, strict=True)), 0 * self._inertial)
            return self._structure_answer(self.mapping.to_cloth(defect))
        before = self.flow.points if self._previous is None else self._previous
        return self.flow.close_volume(2 * self.flow.points - before)

    def _inertia(self, acceleration: Array) -> Array:
        """M_a a (p, 3) [N] on the flow's points; nothing where the scheme leaves it out."""
        if not self.added_mass:
            return 0 * acceleration
        return np.tensordot(np.tensordot(self._rows, acceleration, 2), self._rows, 1)

    def _structure_answer(self, force: Array) -> Array:
        """The interface (p, 3) that nodal ``force`` (n, 3) [N] leads to, its volume closed."""
        with self._timed("structure"):
            nodes = self.structure.solve(force)
        with self._timed("mapping"):
            return self.flow.close_volume(self.mapping.to_flow(nodes))

    @contextmanager
    def _timed(self, part: str) -> Iterator[None]:
        clock = perf_counter()
        yield
        self.wall[part] += perf_counter() - clock

    def save(self) -> dict[str, Array]:
        """The predictor's history."""
        saved = {}
        for k, (f, a) in enumerate(zip(self._force, self._acceleration, strict=True)):
            saved[f"force{k}"], saved[f"acceleration{k}"] = f, a
        if self._previous is not None:
            saved["previous"] = self._previous
        return saved

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        count = sum(name.startswith("force") for name in saved)
        self._force = [saved[f"force{k}"] for k in range(count)]
        self._acceleration = [saved[f"acceleration{k}"] for k in range(count)]
        self._previous = saved.get("previous")


@contextmanager
def _told_from_divergence(time: float, residuals: list[float]) -> Iterator[None]:
    """A side that fails where the iterates run away is the coupling's failure, not its own."""
    try:
        yield
    except ArithmeticError as failure:
        if residuals:
            raise _diverged(time, residuals) from failure
        raise
    except RunFailed as failure:
        if residuals and max(residuals) > 1.0:
            raise _diverged(time, residuals) from failure
        raise


def _diverged(time: float, residuals: list[float]) -> RunFailed:
    last = ", ".join(f"{residual:.1e}" for residual in residuals[-4:])
    return RunFailed(
        f"t = {time:.6g} s: the coupling diverges: the last iterations left residuals of {last} "
        "times the step's own displacement. Take coupling.scheme = 'added-mass' or halve time.step."
    )
