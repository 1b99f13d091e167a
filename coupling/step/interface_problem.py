"""The interface's fixed point of one step: the flow's answer, and the structure's to that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from time import perf_counter

from coupling.finite_volume.swept import pressure_force
from coupling.interface.mapping import InterfaceMap
from coupling.ports import (
    AddedMass,
    Array,
    Flow,
    FlowSample,
    HydrostaticLoad,
    Structure,
)
from coupling.step.defects import Defects
from coupling.step.nearest import nearest


class InterfaceProblem:
    """x = S(F(x)) of the interface x (p, 3) [m] at a step's end, ``structure`` S and ``flow`` F.

    With ``added_mass`` the flow's own inertia operator M_a enters the structure's step, and the
    flow hands back its defect p + M_a a only, which is small and smooth in time: extrapolated from
    former steps it is the predictor. The operator belongs to the shape at the step's end, as the
    diaphragm's velocity has it, and so does the ``mapping``. Where the flow has no mesh for that
    shape, they are those of half the way there.

    The mapped structure misses the liquid's exact volume by what its triangles and the flow's faces
    differ in. The shift that closes it (``Flow.close_volume``) is nearly constant from step to
    step, and no motion: divided by b^2 it would be a false acceleration. So the shift at the shape
    expected is part of the step's map, for the start, the inertial prediction and every answer
    alike. What is then left to close is of second order in the step, and no acceleration either.
    """

    def __init__(
        self, structure: Structure, flow: Flow, mapping: InterfaceMap, *, added_mass: bool
    ) -> None:
        self.structure, self.flow, self.mapping = structure, flow, mapping
        self.added_mass = added_mass
        self.wall = {"structure": 0.0, "fluid": 0.0, "mapping": 0.0}
        self.start: Array  # (p, 3) [m], of the interface in this step
        self.moves = False  # the map, from step to step
        self._shift: Array  # (p, 3) [m], of the step's map: closes the volume where expected
        self._closure: Array  # (p, 3) [m], of the structure's last answer, beyond that
        self._defects = Defects()
        self._inertia: AddedMass | None = None  # of this step

    def begin_step(self, time: float, dt: float, load: HydrostaticLoad) -> Array:
        """Open the step from ``time`` [s] on both sides; the predicted interface (p, 3) [m].

        Raises ``StepFailed``, ArithmeticError.
        """
        self._step, self._begun = (time, dt, load), self.mapping.save()
        state = self.structure.state
        return nearest(self._open, state.position + dt * state.velocity, state.position)

    def remap(self) -> Array:
        """Open the step again, on the map for where the structure's last answer lies."""
        return nearest(self._open, self._nodes, self.structure.state.position)

    def abandon(self) -> None:
        """Leave the step, as if it had never begun."""
        self.mapping.restore(self._begun)

    def _open(self, nodes: Array) -> Array:
        """As ``begin_step``, on the map for ``nodes`` (n, 3) [m] at the step's end."""
        self.mapping.restore(self._begun)
        time, dt, load = self._step
        state = self.structure.state
        with self._timed("mapping"):
            shell = self.mapping.begin_step(state, dt, nodes)
            self.moves = shell is not None
            self.flow.begin_step(time, dt, shell)
            mapped = self.mapping.to_flow(nodes)
            ahead = self.flow.close_volume(mapped)
            self._shift = ahead - mapped
            self.start = self.flow.points
            if self.moves:
                self.start = self.flow.close_volume(self._to_flow(state.position))
                self.flow.slide(self.start)
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
        self._inertial = self._to_flow(self.structure.inertial_prediction())

    def _to_flow(self, nodes: Array) -> Array:
        """The interface (p, 3) [m] of nodes (n, 3) [m], in the step's map."""
        return self.mapping.to_flow(nodes) + self._shift

    def image(self, points: Array) -> Array:
        """S(F(x)) (p, 3) [m] of ``points`` x (p, 3) [m], both of the liquid's volume.

        Raises ``RunFailed``, ArithmeticError.
        """
        with self._timed("fluid"):
            self._pressure = self.flow.solve(points)
        self._points = points
        return self._answer(points, self._pressure)

    def surrogate(self) -> Callable[[Array], Array]:
        """S(F~(y)), with F~(y) - F(x) as the flow's inertia alone has it, x the last one solved.

        Raises ``StepFailed``, ArithmeticError, as what it returns does.
        """
        pressure = self._pressure - self._inertial_pressure(self._points)
        return lambda points: self._answer(points, pressure + self._inertial_pressure(points))

    def _inertial_pressure(self, points: Array) -> Array:
        with self._timed("fluid"):
            return self.flow.inertial_pressure(points)

    def close_volume(self, points: Array) -> Array:
        """The nearest interface to ``points`` (p, 3) [m] that encloses the liquid's volume."""
        with self._timed("mapping"):
            return self.flow.close_volume(points)

    def _answer(self, points: Array, pressure: Array) -> Array:
        """The interface (p, 3) that ``pressure`` (F,) [Pa] on it at ``points`` (p, 3) leads to."""
        force = pressure_force(points, self.flow.faces, pressure)
        if self._inertia is not None:
            force = force + self._inertia.force(self._acceleration(points))
        return self._structure_answer(force)

    def _acceleration(self, points: Array) -> Array:
        """Of the interface (p, 3) [m/s^2] that ends the step at ``points`` (p, 3) [m]."""
        return (points - self._closure - self._inertial) / self.structure.acceleration_scale

    def _structure_answer(self, force: Array) -> Array:
        """The interface (p, 3) that ``force`` (p, 3) [N] on it leads to, its volume closed."""
        with self._timed("structure"):
            self._nodes = self.structure.solve(self.mapping.to_cloth(force))
        mapped = self._to_flow(self._nodes)
        closed = self.close_volume(mapped)
        self._closure = closed - mapped
        return closed

    def accept_step(self) -> FlowSample:
        """Commit what the last call of ``image`` solved."""
        if self._inertia is not None:
            inertial = self._inertia.pressure(self._acceleration(self._points))
            self._defects.add(self._pressure + inertial, self._step[1])
        self.structure.accept_step()
        return self.flow.accept_step()

    @contextmanager
    def _timed(self, part: str) -> Iterator[None]:
        clock = perf_counter()
        try:
            yield
        finally:
            self.wall[part] += perf_counter() - clock

    def save(self) -> dict[str, Array]:
        """The predictor's history, and the map's."""
        return self._defects.save() | self.mapping.save()

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._defects.restore(saved)
        self.mapping.restore(saved)
