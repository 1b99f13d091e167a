"""One coupled step: structure and flow solved in turn until they agree on the interface."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from time import perf_counter

from coupling.convergence import Convergence
from coupling.defects import Defects
from coupling.interface import pressure_force
from coupling.mapping import InterfaceMap
from coupling.ports import (
    AddedMass,
    Array,
    Flow,
    FlowSample,
    HydrostaticLoad,
    RunFailed,
    Scheme,
    StepFailed,
    Structure,
)

DIVERGED = 1e3  # residual over the step's displacement: no scheme comes back from there
SLOW, MAPS = 8, 3  # iterations on a map before its rate is judged; maps of a step, at most


@dataclass(frozen=True, kw_only=True)
class StepOutcome:
    """What a coupled step took, in all parts and tries.

    ``residual`` is relative, as ``Convergence`` has it, and the largest of the parts. ``sample`` is
    that of the end, with the work of all ``parts``.
    """

    iterations: int
    residual: float
    converged: bool
    sample: FlowSample
    parts: list[FlowSample]


class CoupledStep:
    """Couples ``structure`` and ``flow`` through ``mapping`` by ``scheme``.

    With ``added_mass`` the flow's own inertia operator M_a enters the structure's step, and the
    flow hands back its defect p + M_a a only, which is small and smooth in time: extrapolated from
    former steps it is the predictor. The operator belongs to the shape at the step's end, as the
    diaphragm's velocity has it. ``record`` is told of every iteration: time [s], iteration,
    relative residual, seconds.

    The map too is that of where the diaphragm is heading. Where a slam stops it, the map leads
    astray and the iteration is slow: then it is made anew for where the diaphragm has come to.
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
        self.structure, self.flow, self.mapping, self.scheme = structure, flow, mapping, scheme
        self.added_mass = added_mass
        self.convergence = convergence
        self.max_iterations = max_iterations
        self.record = record
        self.wall = {"structure": 0.0, "fluid": 0.0, "mapping": 0.0}
        self._defects = Defects()
        self._inertia: AddedMass | None = None  # of this step
        self._tried, self._parts = 0, list[tuple[float, FlowSample]]()  # since ``told`` was asked

    def advance(self, time: float, dt: float, load: HydrostaticLoad) -> StepOutcome:
        """Solve and commit the step from ``time`` to ``time + dt`` [s] under ``load``, in one."""
        self.attempt(time, dt, load)
        self.accept()
        return self.told()

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]. Raises ``StepFailed``, ArithmeticError.

        Iterations that end before they have converged are no failure; ``told`` says so.
        """
        begun, scheme = self.mapping.save(), self.scheme.save()
        try:
            self._solve(time, dt, load, begun)
        except (StepFailed, ArithmeticError):
            self.mapping.restore(begun)
            self.scheme.restore(scheme)
            raise
        return True

    def _solve(
        self, time: float, dt: float, load: HydrostaticLoad, begun: Mapping[str, Array]
    ) -> None:
        """Iterate; ``begun`` is the map's state before."""
        made, maps = 0, 1
        x = self._begin(time, dt, load, self._heading(dt))
        residuals: list[float] = []
        for iteration in range(1, self.max_iterations + 1):
            clock = perf_counter()
            self._tried += 1
            with _told_from_divergence(time + dt, residuals):
                with self._timed("fluid"):
                    pressure = self.flow.solve(x)
                force = pressure_force(x, self.flow.faces, pressure)
                acceleration = (x - self._inertial) / self.structure.acceleration_scale
                if self._inertia is not None:
                    force = force + self._inertia.force(acceleration)
                image = self._structure_answer(force)
            relative = self.convergence.relative(image - x, x - self._start, dt)
            residuals.append(relative)
            self.record(time + dt, iteration, relative, perf_counter() - clock)
            self._residual = relative
            if relative <= self.convergence.tolerance or iteration == self.max_iterations:
                break
            since = residuals[made:]
            slow = (len(since) > SLOW and self.convergence.is_far(since)) or not relative < DIVERGED
            if slow and self._inertia is not None and self._map_moves and maps < MAPS:
                self.mapping.restore(begun)
                x = self._begin(time, dt, load, self._nodes)
                made, maps = iteration, maps + 1
                continue
            if not relative < DIVERGED:
                raise _diverged(time + dt, residuals)
            update = self.scheme.update(x.ravel(), (image - x).ravel()).reshape(x.shape)
            with self._timed("mapping"):
                x = self.flow.close_volume(update)
        if self._inertia is not None:
            self._defect = pressure + self._inertia.pressure(acceleration), dt

    def accept(self) -> None:
        """Commit the last attempt."""
        if self._inertia is not None:
            self._defects.add(*self._defect)
        self.scheme.accept_step()
        self.structure.accept_step()
        self._parts.append((self._residual, self.flow.accept_step()))

    def told(self) -> StepOutcome:
        """What the steps since this was last asked took, as one; the sample's work is of all."""
        tried, self._tried = self._tried, 0
        parts, self._parts = self._parts, []
        residual, last = max(residual for residual, _ in parts), parts[-1][1]
        return StepOutcome(
            iterations=tried,
            residual=residual,
            converged=residual <= self.convergence.tolerance,
            sample=replace(last, pressure_work=sum(sample.pressure_work for _, sample in parts)),
            parts=[sample for _, sample in parts],
        )

    def _heading(self, dt: float) -> Array:
        """Where the structure's nodes (n, 3) [m] will be at the end of a step of ``dt`` [s]."""
        state = self.structure.state
        return state.position + dt * state.velocity

    def _begin(self, time: float, dt: float, load: HydrostaticLoad, nodes: Array) -> Array:
        """Open the step on both sides, on the map for ``nodes`` (n, 3) [m] at its end.

        Returns the predicted interface (p, 3).
        """
        self.scheme.begin_step()
        state = self.structure.state
        with self._timed("mapping"):
            shell = self.mapping.begin_step(state, dt, nodes)
            self._map_moves = shell is not None
            self.flow.begin_step(time, dt, shell)
            self._start = self.flow.points
            if self._map_moves:
                self._start = self.flow.close_volume(self.mapping.to_flow(state.position))
                self.flow.slide(self._start)
            ahead = self.flow.close_volume(self.mapping.to_flow(nodes))
        if not self.added_mass:
            self._begin_structure(dt, load)
            return ahead
        with self._timed("fluid"):
            self._inertia = self.flow.added_mass(ahead)
        with self._timed("mapping"):
            rows = self.mapping.rows_to_cloth(self._inertia.rows)
        self._begin_structure(dt, load, rows)
        defect = self._defects.next(len(self.flow.faces), dt)
        return self._structure_answer(pressure_force(ahead, self.flow.faces, defect))

    def _begin_structure(self, dt: float, load: HydrostaticLoad, rows: Array | None = None) -> None:
        with self._timed("structure"):
            self.structure.begin_step(dt, load, rows)
        self._inertial = self.mapping.to_flow(self.structure.inertial_prediction())

    def _structure_answer(self, force: Array) -> Array:
        """The interface (p, 3) that ``force`` (p, 3) [N] on it leads to, its volume closed."""
        with self._timed("structure"):
            self._nodes = self.structure.solve(self.mapping.to_cloth(force))
        with self._timed("mapping"):
            return self.flow.close_volume(self.mapping.to_flow(self._nodes))

    @contextmanager
    def _timed(self, part: str) -> Iterator[None]:
        clock = perf_counter()
        try:
            yield
        finally:
            self.wall[part] += perf_counter() - clock

    def save(self) -> dict[str, Array]:
        """The predictor's history."""
        saved = self._defects.save()
        return saved | self.mapping.save()

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._defects.restore(saved)
        self.mapping.restore(saved)


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
            # Where the solver itself has died nothing is left to take the step in parts with.
            kind = StepFailed if isinstance(failure, StepFailed) else RunFailed
            raise _diverged(time, residuals, kind) from failure
        raise


def _diverged(time: float, residuals: list[float], kind: type[RunFailed] = StepFailed) -> RunFailed:
    last = ", ".join(f"{residual:.1e}" for residual in residuals[-4:])
    return kind(
        f"t = {time:.6g} s: the coupling diverges: the last iterations left residuals of {last} "
        "times the step's own displacement. Take coupling.scheme = 'added-mass' or halve time.step."
    )
