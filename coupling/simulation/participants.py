"""The two sides of a scene's interface, and the step that couples them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

from cloth.energy import SheetLosses, mean_losses
from cloth.mesh import rest_gradients
from coupling.fluids import FLUIDS
from coupling.fluids.model import Record
from coupling.fluids.supply import supply_of
from coupling.interface.liquid_shape import liquid_cg
from coupling.metrics.expulsion import Expulsion
from coupling.metrics.fold_figures import FoldFigures
from coupling.motion.frame import frame_of
from coupling.ports import AnyArray, Array, HydrostaticLoad, LiquidSample, StepReport, TimeStep
from coupling.scene.choices import AUTO
from coupling.scene.scene import Scene
from coupling.simulation.carried import carrier_of
from coupling.simulation.energy import Instant, instant_of
from coupling.simulation.pressure_band import PressureBand
from coupling.simulation.sampling import at_nodes, sample_at, still
from coupling.simulation.tally import Tally
from coupling.step.dry import DryStep
from coupling.step.halving import ErrorControl, Halving
from coupling.store.attitude import rotation_vector
from coupling.store.run_record import Sample
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm


class Participants:
    """Diaphragm and liquid of ``scene``: settled, coupled, stepped, sampled and saved together.

    First ``start`` or ``restore``, then ``advance``. A flow's files go to ``folder``; ``tally``
    counts what is done and how long it takes.
    """

    def __init__(self, scene: Scene, folder: Path) -> None:
        if scene.model.fluid == AUTO:
            raise ValueError(
                'model.fluid = "auto": take a model first, as coupling.campaign.auto.run_auto does'
            )
        self.scene, self.folder = scene, folder
        self.frame, self.supply = frame_of(scene), supply_of(scene)
        self.model = FLUIDS[scene.model.fluid]
        self._load_model = self.model.load_model(scene)
        # Of the last step; at rest.
        self._load = self._load_model.load(self.frame.gravity_at(0.0), self.supply.volume(0.0))
        self.cloth = diaphragm_of(scene)
        _, areas = rest_gradients(self.cloth.reference, self.cloth.triangles)
        self.folds = FoldFigures(scene, self.cloth.reference, self.cloth.triangles)
        self.expulsion = Expulsion(scene, self.cloth.triangles)
        self.tally = Tally(scene, self.cloth.thickness, areas)
        self.carrier = carrier_of(
            scene, self.frame, sheet=float(self.cloth.mass.sum()), felt=self.model.has_flow
        )
        self.step: TimeStep = DryStep(self.cloth)  # until the liquid is there
        self.halving = Halving(control=self._error_control(), again=self._again)
        self.band = PressureBand(scene)
        self.settled: dict[str, AnyArray] = {}  # the diaphragm at rest
        self._parts: list[tuple[float, SheetLosses, bool]] = []  # of the last step: length [s], ...

    def _moment(self) -> Array:
        """First moment (3,) [kg m] of the sheet, and of a liquid that has a flow."""
        if self.model.has_flow:
            return self._weight()
        return np.asarray(self.cloth.mass @ self.cloth.state.position)

    def _weight(self) -> Array:
        """First moment (3,) [kg m] of sheet and liquid."""
        state, liquid = self.cloth.state, self.scene.liquid.density
        cg = liquid_cg(state.position, self.cloth.triangles, self.scene.tank.shell, state.volume)
        return np.asarray(self.cloth.mass @ state.position + liquid * state.volume * cg)

    def _error_control(self) -> ErrorControl | None:
        """What bounds the error of a step, where the scene asks for it."""
        tolerance = self.scene.time.step_tolerance
        if tolerance is None:
            return None
        return ErrorControl(
            error=lambda: self.cloth.local_error, tolerance=tolerance * self.scene.tank.shell.size
        )

    def settle(self) -> None:
        """Bring the diaphragm to rest at its level. Raises ``RunFailed`` where it finds none."""
        with self._timed("structure"):
            self.tally.statistics.settle_residual = settle_diaphragm(
                self.cloth, self.scene, self._load
            )

    def start(self, record: Record) -> None:
        """Put the liquid at rest below the settled diaphragm.

        ``record`` is called after every coupling iteration, as ``FluidModel.time_step`` has it.
        """
        self._couple(record)
        self.carrier.start(self._moment(), self._weight())
        with self._timed("fluid"):
            self.step.start()

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
        self.step.restore(saved)
        self.halving.restore(saved["halving"])
        self.band.restore(saved["band"])
        self.carrier.restore(saved.get("carrier", {}))

    def _couple(self, record: Record) -> None:
        """Build the step of the settled diaphragm with its liquid."""
        self.settled = self.cloth.save()
        self.step = self.model.time_step(self.scene, self.cloth, self.folder, record)
        self.tally.statistics.flow_solver = self.step.solver

    def advance(self, now: float, after: float) -> StepReport:
        """One step from ``now`` to ``after`` [s]; what it took.

        Raises ``RunFailed`` when too many steps did not converge.
        """
        dt, tally = self.scene.time.step, self.tally
        self._parts = []
        self.carrier.begin_step()
        try:
            parts = self.halving.advance(self.step, now, dt, self.load, taken=self._taken)
        finally:
            for part, seconds in self.step.seconds().items():
                tally.statistics.wall_by_part[part] += seconds
        report, state = self.step.report(), self.cloth.state
        tally.coupling(after, report, volume=state.volume, supplied=self.supply.volume(after))
        tally.structure(after, state, converged=self._converged, steps=parts)
        return report

    def _taken(self, dt: float) -> None:
        """Note the end of a part of ``dt`` [s]."""
        body_force = self.carrier.accept(self._moment, self._load.body_force, self.cloth.turned)
        self._load = replace(self._load, body_force=body_force)
        self._parts.append((dt, self.cloth.losses(), self.cloth.converged))
        self.tally.solved(self.cloth.iterations, converged=self.cloth.converged)
        self.tally.stretched(dt, self.cloth.state)

    @property
    def _converged(self) -> bool:
        return all(converged for _, _, converged in self._parts)

    def _losses(self) -> SheetLosses:
        """Means over the last step."""
        return mean_losses([(dt, losses) for dt, losses, _ in self._parts])

    def load(self, start: float, end: float) -> HydrostaticLoad:
        """The liquid's load in a step from ``start`` to ``end`` [s], after the committed state."""
        previous = self.cloth.previous_step
        body_force = self.carrier.body_force(start, end, previous)
        load = self._load_model.load(body_force, self.supply.volume(end))
        self._load = replace(load, turn=self.carrier.turn, recoil=self.carrier.recoil)
        return self._load

    def _again(self) -> HydrostaticLoad | None:
        """The load in the attitude that the last attempt has found, None where it presumed that."""
        if self.cloth.attitude_found:
            return None
        body_force = self.carrier.again(self.cloth.turned)
        self._load = replace(
            self._load, body_force=body_force, turn=self.carrier.turn, recoil=self.carrier.recoil
        )
        return self._load

    def _acceleration(self, time: float) -> Array:
        """Of the tank (3,) [m/s^2] at ``time`` [s], of a record its mean over the step before."""
        if time == 0.0:
            return np.zeros(3)
        return self.carrier.acceleration(time - self.scene.time.step, time)

    def instant(self, time: float, liquid: LiquidSample | None) -> Instant:
        """What the energy balance needs to know of the committed state at ``time`` [s]."""
        shaking = np.zeros(3)
        if time > 0.0:
            shaking = self.carrier.working_acceleration(time - self.scene.time.step, time)
        return instant_of(
            self.cloth, self.cloth.state, liquid, self.scene, self._losses(),
            acceleration=shaking, load=self._load, turned=self._turned(time),
        )  # fmt: skip

    def _turned(self, time: float) -> tuple[Array, Array] | None:
        """Attitude (3, 3) and rate (3,) [rad/s] of a tank that turns, None of any other."""
        attitude = self.carrier.attitude(time)
        return None if attitude is None else (attitude, self.carrier.rate(time))

    def _rotation(self, time: float) -> Array:
        """Rotation vector (3,) [rad] of the tank."""
        attitude = self.carrier.attitude(time)
        return np.zeros(3) if attitude is None else rotation_vector(attitude)

    def sample(self, time: float, report: StepReport, metrics: dict[str, float]) -> Sample:
        """Results of the committed state at ``time`` [s], with ``metrics`` among its own."""
        state, liquid = self.cloth.state, report.sample
        own = self.folds.metrics(state) | self.expulsion.metrics(state, self._load)
        pressures = still(len(state.position))
        if liquid is not None:
            pressures = at_nodes(liquid, self.step.to_nodes)
        sample = sample_at(
            time, state=state, triangles=self.cloth.triangles, shell=self.scene.tank.shell,
            load=self._load, acceleration=self._acceleration(time),
            displacement=self.carrier.displacement(time), rotation=self._rotation(time),
            rate=self.carrier.rate(time), flow=liquid, pressures=pressures,
            iterations=report.iterations, residual=report.residual,
            metrics=metrics | self.step.metrics(liquid) | own | self.carrier.metrics(),
        )  # fmt: skip
        if liquid is not None:
            self.band.add(sample, self.cloth.triangles)
        return sample

    def write_fields(self) -> None:
        """Leave the flow's fields as committed in its folder, where the scene asks for them."""
        self.step.write_fields()

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Everything ``restore`` needs to go on bit for bit."""
        return {
            "settled": self.settled, "structure": self.cloth.save(),
            "halving": self.halving.save(), "band": self.band.save(),
            "carrier": self.carrier.save(),
        } | self.step.save()  # fmt: skip

    def close(self) -> None:
        """End a flow's solver, and count what has been gathered."""
        self.tally.statistics.dynamic_in_band = self.band.fraction
        size = self.step.close()
        if size is not None:
            self.tally.statistics.flow_fields_bytes = size
