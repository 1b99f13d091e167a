"""The interface's fixed point of one step: the flow's answer, and the structure's to that."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from coupling.finite_volume.swept import pressure_force
from coupling.interface.mapping import InterfaceMap
from coupling.ports import Array, Flow, FlowSample, HydrostaticLoad, InterfaceMotion, Structure
from coupling.step.backtracking import Backtracking
from coupling.step.interface_step import Answer, InterfaceStep, Iterate, StepRequest, known
from coupling.step.mapped_motion import mapped_motion
from coupling.step.mismatch import VelocityMismatch
from coupling.step.stopwatch import Stopwatch


class InterfaceProblem:
    """x = S(F(x)) of the interface x (p, 3) [m] at a step's end, ``structure`` S and ``flow`` F.

    With ``takes_inertia`` the flow's own inertia operator M_a enters the structure's step, and the
    flow hands back its defect p + M_a a only, which is small and smooth in time: that of the step
    before is the predictor. There a is the flow's: the structure's, and what makes up for the
    difference that the step before has left (``VelocityMismatch``). The operator belongs to the
    shape at the step's end, as the diaphragm's velocity has it, and so does the ``mapping``. Where
    the flow has no mesh for that shape, they are those of half the way there.

    The mapped structure misses the liquid's exact volume by what its triangles and the flow's faces
    differ in. The shift that closes it (``Flow.close_volume``) is nearly constant from step to
    step, and no motion: divided by b^2 it would be a false acceleration. So the shift at the shape
    expected is part of the step's map, for the start, the inertial prediction and every answer
    alike. What is then left to close is of second order in the step, and no acceleration either.
    """

    def __init__(
        self,
        structure: Structure,
        flow: Flow,
        mapping: InterfaceMap,
        *,
        takes_inertia: bool,
        backtracking: Backtracking,
    ) -> None:
        self.structure, self.flow, self.mapping = structure, flow, mapping
        self.takes_inertia, self.backtracking = takes_inertia, backtracking
        self.watch = Stopwatch("structure", "fluid", "mapping")
        self._defect = np.zeros(())  # p + M_a a (F,) [Pa] of the last step
        self._mismatch = VelocityMismatch()
        self._request: StepRequest | None = None
        self._step: InterfaceStep | None = None
        self._answer: Answer | None = None  # the structure's last
        self._solved: Iterate | None = None  # the last of ``image``
        self._moved: InterfaceMotion | None = None  # how its interface moved

    @property
    def step(self) -> InterfaceStep:
        """The step that has begun, on its present map."""
        return known(self._step)

    @property
    def moves(self) -> bool:
        """Whether the map changes from step to step."""
        return self.step.map.shell is not None

    def begin_step(self, time: float, dt: float, load: HydrostaticLoad) -> Array:
        """Open the step from ``time`` [s] on both sides; the predicted interface (p, 3) [m].

        Raises ``StepFailed``, ArithmeticError.
        """
        self._request = StepRequest(time=time, dt=dt, load=load, before=self.mapping.save())
        state = self.structure.state
        expected = state.position + dt * state.velocity
        if load.turn is not None:
            expected = expected @ load.turn.last.T
        return self.backtracking.nearest(self._open, expected, state.position)

    def remap(self) -> Array:
        """Open the step again, on the map for where the structure's last answer lies."""
        nodes = known(self._answer).nodes
        return self.backtracking.nearest(self._open, nodes, self.structure.state.position)

    def abandon(self) -> None:
        """Leave the step, as if it had never begun."""
        self.mapping.restore(known(self._request).before)

    def _open(self, nodes: Array) -> Array:
        """As ``begin_step``, on the map for ``nodes`` (n, 3) [m] at the step's end."""
        request, state = known(self._request), self.structure.state
        self.mapping.restore(request.before)
        with self.watch.timed("mapping"):
            step_map = self.mapping.begin_step(state, request.dt, nodes)
            shell = step_map.shell
            mapped = step_map.to_flow(nodes)
            ahead = self.flow.close_volume(mapped, shell)
            shift = ahead - mapped
            start = self.flow.points
            if shell is not None:
                start = self.flow.close_volume(step_map.to_flow(state.position) + shift, shell)
            turn = request.load.turn
            self.flow.begin_step(request.time, request.dt, shell=shell, turn=turn)
        inertia, rows = None, None
        if self.takes_inertia:
            with self.watch.timed("fluid"):
                inertia = self.flow.liquid_inertia(ahead)
            with self.watch.timed("mapping"):
                rows = inertia.weighted(step_map.rows_to_cloth(inertia.swept))
        with self.watch.timed("structure"):
            self.structure.begin_step(request.dt, request.load, rows)
        self._step = InterfaceStep(
            map=step_map,
            start=start,
            shift=shift,
            motion=mapped_motion(self.structure, step_map, nodes, shift, turn),
            inertia=inertia,
        )
        self._answer = Answer(nodes=nodes, points=ahead, closure=np.zeros_like(ahead))
        return ahead if inertia is None else self._predicted(ahead)

    def _predicted(self, ahead: Array) -> Array:
        """Where the defect carried on takes the structure, expected at ``ahead`` (p, 3)."""
        pressure = self._defect - self._inertial_pressure(np.zeros_like(ahead))
        return self._structure_answer(pressure_force(ahead, self.flow.faces, pressure)).points

    def _inertial_pressure(self, acceleration: Array) -> Array:
        """M_a a (F,) [Pa] of the flow, where the structure has the ``acceleration`` (p, 3)."""
        more = self._mismatch.acceleration(known(self._request).dt)
        return known(self.step.inertia).pressure(acceleration + more)

    def image(self, points: Array) -> Iterate:
        """The iterate at ``points`` x (p, 3) [m], whose volume is closed first.

        Raises ``RunFailed`` (``StepFailed`` where a shorter step may do), ArithmeticError.
        """
        points, motion = self.close_volume(points), self._motion
        with self.watch.timed("fluid"):
            pressure = self.flow.solve(points, motion if self.moves else None)
        image = self._image(points, pressure)
        self._solved, self._moved = Iterate(points=points, pressure=pressure, image=image), motion
        return self._solved

    def close_volume(self, points: Array) -> Array:
        """The nearest interface to ``points`` (p, 3) [m] that encloses the liquid's volume."""
        with self.watch.timed("mapping"):
            return self.flow.close_volume(points)

    def _image(self, points: Array, pressure: Array) -> Array:
        """The interface (p, 3) that ``pressure`` (F,) [Pa] on it at ``points`` (p, 3) leads to."""
        force = pressure_force(points, self.flow.faces, pressure)
        if self.step.inertia is not None:
            force = force + self.step.inertia.force(self._motion.acceleration(points))
        return self._structure_answer(force).points

    @property
    def _motion(self) -> InterfaceMotion:
        """How the interface moves; what closing the last answer's volume took is no motion."""
        return self.step.motion.shifted(known(self._answer).closure)

    def _structure_answer(self, force: Array) -> Answer:
        """What ``force`` (p, 3) [N] on the interface leads to."""
        with self.watch.timed("structure"):
            nodes = self.structure.solve(self.step.map.to_cloth(force))
        mapped = self.step.to_flow(nodes)
        closed = self.close_volume(mapped)
        self._answer = Answer(nodes=nodes, points=closed, closure=closed - mapped)
        return self._answer

    def accept_step(self) -> FlowSample:
        """Commit what the last call of ``image`` solved."""
        if self.step.inertia is not None:
            solved, motion = known(self._solved), known(self._moved)
            inertial = self._inertial_pressure(motion.acceleration(solved.points))
            self._defect = solved.pressure + inertial
            ahead = self._motion.velocity(solved.image) - motion.velocity(solved.points)
            self._mismatch.add(ahead, known(self._request).dt)
        self.structure.accept_step()
        return self.flow.accept_step()

    def save(self) -> dict[str, Array]:
        """The predictor's history, and the map's."""
        return {"defect": self._defect} | self._mismatch.save() | self.mapping.save()

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
        self._defect = saved["defect"]
        self._mismatch.restore(saved)
        self.mapping.restore(saved)
