"""The two sides of a scene's interface, and the step that couples them."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter

import numpy as np

from cloth.energy import SheetLosses, mean_losses
from cloth.mesh import rest_gradients
from coupling.fluids.liquid import flow_of, load_model, potential_of, start_flow
from coupling.motion.kinds import motion_of
from coupling.ports import AnyArray, Array, FlowSample, HydrostaticLoad, LiquidSample
from coupling.run.energy import Instant, instant_of
from coupling.run.sampling import at_nodes, flow_metrics, liquid_metrics, sample_at, still
from coupling.run.tally import Tally
from coupling.scene.scene import Scene
from coupling.schemes import scheme_named
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledStep
from coupling.step.potential import PotentialStep
from coupling.step.substeps import HALVINGS, DryStep, advance
from coupling.store.run_record import Sample
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm

Record = Callable[[float, int, float, float], None]
_log = logging.getLogger(__name__)


class Participants:
    """Diaphragm and liquid of ``scene``: settled, coupled, stepped, sampled and saved together.

    First ``start`` or ``restore``, then ``advance``. A flow's files go to ``folder``; ``tally``
    counts what is done and how long it takes.
    """

    def __init__(self, scene: Scene, folder: Path) -> None:
        self.scene, self.folder = scene, folder
        self.motion = motion_of(scene)
        self.model = load_model(scene)
        self._load = self.model.load(np.asarray(scene.gravity))  # of the last step; at rest
        self.cloth = diaphragm_of(scene)
        _, areas = rest_gradients(self.cloth.reference, self.cloth.triangles)
        self.tally = Tally(scene, self.cloth.thickness, areas)
        self.step: DryStep | PotentialStep | CoupledStep = DryStep(self.cloth)
        self._parts: list[tuple[float, SheetLosses, bool]] = []  # of the last step: length [s], ...

    def settle(self) -> None:
        """Bring the diaphragm to rest at its level. Raises ``RunFailed`` where it finds none."""
        with self._timed("structure"):
            self.tally.statistics.settle_residual = settle_diaphragm(
                self.cloth, self.scene, self._load
            )

    def start(self, record: Record) -> None:
        """Couple the liquid, at rest, to the settled diaphragm.

        ``record`` is told of every coupling iteration, as ``CoupledStep`` has it.
        """
        self._couple(record)
        if isinstance(self.step, CoupledStep):
            with self._timed("fluid"):
                start_flow(self.flow, self.mapping, self.scene, self.cloth)

    @contextmanager
    def _timed(self, part: str) -> Iterator[None]:
        """Add the wall time of what is done to ``part``, also where that fails."""
        clock = perf_counter()
        try:
            yield
        finally:
            self.tally.seconds(part, clock)

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]], record: Record) -> None:
        """The reverse of ``save``, in place of ``settle`` and ``start``."""
        self.cloth.restore(saved["settled"])
        self.cloth.held = self.scene.diaphragm.held
        self._couple(record)
        self.cloth.restore(saved["structure"])
        if isinstance(self.step, CoupledStep):
            self.flow.restore(saved["flow"])
            self.step.scheme.restore(saved.get("scheme", {}))
        if not isinstance(self.step, DryStep):
            self.step.restore(saved.get("coupled", {}))

    def _couple(self, record: Record) -> None:
        """Build the liquid and the coupling for the settled diaphragm, where the liquid moves."""
        self.settled = self.cloth.save()
        scene = self.scene
        if scene.model.fluid == "potential":
            self.step = PotentialStep(
                self.cloth, potential_of(scene, self.cloth), radius=scene.tank.radius
            )
        if scene.model.fluid != "openfoam":
            return
        self.flow, self.mapping = flow_of(scene, self.folder, self.cloth)
        self.tally.statistics.flow_solver = self.flow.case.solver
        _log.info("flow solver: %s", self.flow.case.solver)
        scheme, added_mass = scheme_named(
            scene.coupling.scheme, relaxation=scene.coupling.relaxation, reuse=scene.coupling.reuse
        )
        gravity = float(np.linalg.norm(scene.gravity))
        self.step = CoupledStep(
            self.cloth, self.flow, self.mapping, scheme, added_mass=added_mass,
            convergence=Convergence(tolerance=scene.coupling.tolerance, acceleration=gravity),
            max_iterations=scene.coupling.max_iterations, record=record,
        )  # fmt: skip

    def advance(self, now: float, after: float) -> tuple[LiquidSample | None, int, float]:
        """One step from ``now`` to ``after`` [s]: the liquid's sample, iterations, residual.

        Raises ``RunFailed`` when too many steps did not converge.
        """
        dt, tally, step = self.scene.time.step, self.tally, self.step
        whole = isinstance(step, CoupledStep) and not self.flow.case.uneven_steps
        self._parts = []
        with self._step_timed():
            parts = advance(
                step, now, dt, self.load, halvings=0 if whole else HALVINGS, taken=self._taken
            )
        if isinstance(step, CoupledStep):
            return self._coupled(step, after, parts)
        state = self.cloth.state
        tally.volume(abs(state.volume / self.scene.liquid_volume - 1.0))
        tally.structure(after, state, converged=self._converged, steps=parts)
        if isinstance(step, DryStep):
            return None, 1, 0.0
        sample, shapes, residual = step.told()
        tally.liquid(sample, shapes)
        return sample, shapes, residual

    @contextmanager
    def _step_timed(self) -> Iterator[None]:
        """Add the wall time of a step to its parts, also where it fails."""
        clock, step = perf_counter(), self.step
        by_part = self.tally.statistics.wall_by_part
        try:
            yield
        finally:
            if isinstance(step, CoupledStep):
                for part, seconds in step.wall.items():
                    by_part[part] += seconds
                    step.wall[part] = 0.0
            else:
                self.tally.seconds("structure", clock)
            if isinstance(step, PotentialStep):
                by_part["structure"] -= step.wall
                by_part["fluid"] += step.wall
                step.wall = 0.0

    def _taken(self, dt: float) -> None:
        """Note the end of a part of ``dt`` [s]."""
        self._parts.append((dt, self.cloth.losses(), self.cloth.converged))
        self.tally.solved(self.cloth.iterations, converged=self.cloth.converged)
        self.tally.stretched(dt, self.cloth.state)

    @property
    def _converged(self) -> bool:
        return all(converged for _, _, converged in self._parts)

    def _losses(self) -> SheetLosses:
        """Means over the last step."""
        return mean_losses([(dt, losses) for dt, losses, _ in self._parts])

    def _coupled(
        self, step: CoupledStep, after: float, parts: int
    ) -> tuple[FlowSample, int, float]:
        outcome = step.told()
        self.tally.coupling(after, outcome)
        self.tally.structure(after, self.cloth.state, converged=self._converged, steps=parts)
        return outcome.sample, outcome.iterations, outcome.residual

    def load(self, start: float, end: float) -> HydrostaticLoad:
        """The liquid's load in a step from ``start`` to ``end`` [s], after the committed state."""
        shaking = self.motion.step_acceleration(start, end, self.cloth.previous_step)
        self._load = self.model.load(np.asarray(self.scene.gravity) - shaking)
        return self._load

    def _acceleration(self, time: float) -> Array:
        """Of the tank (3,) [m/s^2] at ``time`` [s], of a record its mean over the step before."""
        if time == 0.0:
            return np.zeros(3)
        return self.motion.step_acceleration(time - self.scene.time.step, time, 0.0)

    def instant(self, time: float, liquid: LiquidSample | None) -> Instant:
        """What the energy balance needs to know of the committed state at ``time`` [s]."""
        shaking = np.zeros(3)
        if time > 0.0:
            shaking = self.motion.working_acceleration(time - self.scene.time.step, time)
        return instant_of(
            self.cloth, self.cloth.state, liquid, self.scene, self._losses(), acceleration=shaking
        )

    def sample(
        self,
        time: float,
        liquid: LiquidSample | None,
        iterations: int,
        residual: float,
        metrics: dict[str, float],
    ) -> Sample:
        """Results of the committed state at ``time`` [s], with ``metrics`` among its own."""
        state = self.cloth.state
        pressures = still(len(state.position))
        if isinstance(self.step, PotentialStep):
            metrics = (
                metrics | liquid_metrics(liquid) | {"energy_removed": self.step.energy_removed}
            )
            if liquid is not None:
                pressures = at_nodes(liquid, self.step.liquid.to_nodes(state.position).dot)
        elif isinstance(self.step, CoupledStep):
            assert liquid is None or isinstance(liquid, FlowSample)
            mesh = self.flow.non_orthogonality_max, self.flow.wall_distance
            metrics = metrics | flow_metrics(liquid, *mesh)
            if liquid is not None:
                pressures = at_nodes(liquid, self.mapping.to_nodes)
        return sample_at(
            time, state=state, triangles=self.cloth.triangles, radius=self.scene.tank.radius,
            load=self._load, acceleration=self._acceleration(time),
            displacement=self.motion.displacement(time), flow=liquid, pressures=pressures,
            iterations=iterations, residual=residual, metrics=metrics,
        )  # fmt: skip

    def write_fields(self) -> None:
        """Leave the flow's fields as committed in its folder, where the scene asks for them."""
        if isinstance(self.step, CoupledStep) and self.scene.openfoam.write_fields:
            self.flow.write_fields()

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Everything ``restore`` needs to go on bit for bit."""
        saved: dict[str, dict[str, AnyArray]] = {
            "settled": self.settled, "structure": self.cloth.save(),
        }  # fmt: skip
        if isinstance(self.step, CoupledStep):
            saved["flow"] = self.flow.save()
            saved["scheme"] = self.step.scheme.save()
        if not isinstance(self.step, DryStep):
            saved["coupled"] = self.step.save()
        return saved

    def close(self) -> None:
        """End a flow's solver."""
        if isinstance(self.step, CoupledStep):
            self.flow.close()
            if self.scene.openfoam.write_fields:
                self.tally.statistics.flow_fields_bytes = self.flow.case.size
