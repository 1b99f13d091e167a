"""The time loop: the only place where all parts meet."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from threadpoolctl import threadpool_limits

from coupling import checkpoint
from coupling.atomic import write_json
from coupling.convergence import Convergence
from coupling.coupled_step import CoupledStep
from coupling.energy import EnergyBalance, Instant, instant_of, stored_in
from coupling.iteration_log import IterationLog
from coupling.liquid import flow_of, load_model, potential_of, start_flow
from coupling.metrics.summary import summarise
from coupling.motion import motion_of
from coupling.ports import (
    AnyArray,
    FlowSample,
    HydrostaticLoad,
    LiquidSample,
    RunFailed,
)
from coupling.potential_step import PotentialStep
from coupling.results import ResultsWriter, read_results
from coupling.run_record import RunStatistics, Sample
from coupling.sampling import at_nodes, flow_metrics, liquid_metrics, sample_at, still
from coupling.scene import Scene, load_scene, scene_toml, write_scene
from coupling.schemes import scheme_named
from coupling.strength import burst_warning
from coupling.structure import DryStep, advance, diaphragm_of, settle_diaphragm
from coupling.tally import Tally

Progress = Callable[[str, float, float, str], None]
_log = logging.getLogger(__name__)


def run(scene: Scene, folder: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Settle the diaphragm, then shake the tank; results go to ``folder``.

    Returns what ``summary.json`` holds. A run that fails has the status ``failed`` and its reason
    there; what was computed is kept. KeyboardInterrupt passes through; the last
    checkpoint is where ``resume`` goes on.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_scene(scene, folder)
    with _log_file(folder), threadpool_limits(1):
        return _Run(scene, folder, progress).from_start()


def resume(folder: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Go on from the last checkpoint in ``folder``; as ``run``."""
    with _log_file(folder), threadpool_limits(1):
        return _Run(load_scene(folder), folder, progress).from_checkpoint()


class _Run:
    """One run: its parts, and the loop over its steps."""

    def __init__(self, scene: Scene, folder: Path, progress: Progress | None) -> None:
        self.scene, self.folder = scene, folder
        self.progress = progress or (lambda *_: None)
        self.motion = motion_of(scene)
        self.model = load_model(scene)
        self.cloth = diaphragm_of(scene)
        self.tally = Tally(scene, self.cloth.thickness)
        self.energy = EnergyBalance(np.asarray(scene.gravity))
        self.burst = burst_warning(scene)
        self.step: DryStep | PotentialStep | CoupledStep = DryStep(self.cloth)
        self.clock = perf_counter()

    def from_start(self) -> dict[str, Any]:
        """The whole run; returns the summary."""
        self.results = ResultsWriter(
            self.folder, scene_toml=scene_toml(self.scene), model=self.scene.model.fluid,
            reference=self.cloth.reference, triangles=self.cloth.triangles,
        )  # fmt: skip
        self.iterations = IterationLog(self.folder)
        return self._guarded(self._begin)

    def _begin(self) -> None:
        if self.burst is not None:
            _log.warning("%s The run goes on with a sheet that cannot.", self.burst)
        self.progress("settle", 0.0, self.scene.time.settle, "the diaphragm sinks to its level")
        clock = perf_counter()
        self.tally.statistics.settle_change = settle_diaphragm(
            self.cloth, self.scene, self._load(0.0, at_rest=True)
        )
        self.tally.seconds("structure", clock)
        self.progress("settle", self.scene.time.settle, self.scene.time.settle, "settled")
        self._couple()
        if isinstance(self.step, CoupledStep):
            clock = perf_counter()
            start_flow(self.flow, self.mapping, self.scene, self.cloth)
            self.tally.seconds("fluid", clock)
        self.energy.start(self._instant(0.0, None), stored_in(self.cloth, None))
        self._write(self._sample(0.0, None, 0, 0.0))
        self._save(0)
        self._loop(0)

    def from_checkpoint(self) -> dict[str, Any]:
        """The rest of a run whose folder holds a checkpoint; returns the summary."""
        parts, attributes = checkpoint.load_checkpoint(self.folder / "checkpoint.h5")
        step = int(attributes["step"])
        time = step * self.scene.time.step
        self.results = ResultsWriter.resume(self.folder, until=time)
        self.iterations = IterationLog.resume(self.folder, until=time)
        self.tally.statistics = RunStatistics(**attributes["statistics"])
        self.clock -= self.tally.statistics.wall_s

        def begin() -> None:
            self.energy.restore(parts.get("energy", {}))
            self.cloth.restore(parts["settled"])
            self.cloth.held = self.scene.diaphragm.held
            self._couple()
            self.cloth.restore(parts["structure"])
            if isinstance(self.step, CoupledStep):
                self.flow.restore(parts["flow"])
                self.step.scheme.restore(parts.get("scheme", {}))
            if not isinstance(self.step, DryStep):
                self.step.restore(parts.get("coupled", {}))
            self._loop(step)

        return self._guarded(begin)

    def _couple(self) -> None:
        """Build the liquid and the coupling for the settled diaphragm, where the liquid moves."""
        self.settled = self.cloth.save()
        scene = self.scene
        if scene.model.fluid == "potential":
            self.step = PotentialStep(
                self.cloth, potential_of(scene, self.cloth), radius=scene.tank.radius
            )
        if scene.model.fluid != "openfoam":
            return
        self.flow, self.mapping = flow_of(scene, self.folder / "foam", self.cloth)
        self.tally.statistics.flow_solver = self.flow.case.solver
        _log.info("flow solver: %s", self.flow.case.solver)
        scheme, added_mass = scheme_named(
            scene.coupling.scheme, relaxation=scene.coupling.relaxation, reuse=scene.coupling.reuse
        )
        floor = float(np.linalg.norm(scene.gravity)) * scene.time.step**2
        self.step = CoupledStep(
            self.cloth, self.flow, self.mapping, scheme, added_mass=added_mass,
            convergence=Convergence(tolerance=scene.coupling.tolerance, floor=floor),
            max_iterations=scene.coupling.max_iterations, record=self.iterations.write,
        )  # fmt: skip

    def _loop(self, first: int) -> None:
        time = self.scene.time
        for step in range(first, time.steps):
            now, after = step * time.step, (step + 1) * time.step
            flow, iterations, residual = self._advance(now, after)
            work = 0.0 if flow is None else flow.pressure_work
            self.energy.add(time.step, self._instant(after, flow), work)
            self.tally.statistics.steps = step + 1
            self.tally.statistics.simulated_s = after
            if (step + 1) % time.output_every == 0 or step + 1 == time.steps:
                self._write(self._sample(after, flow, iterations, residual))
            if (step + 1) % time.checkpoint_every == 0:
                self._save(step + 1)
            self.progress("shake", after, time.duration, self._text(iterations))

    def _advance(self, now: float, after: float) -> tuple[LiquidSample | None, int, float]:
        """One step; counts what it took. Raises RunFailed when too many did not converge."""
        if isinstance(self.step, CoupledStep):
            return self._advance_coupled(self.step, now, after)
        dt, tally, step = self.scene.time.step, self.tally, self.step
        clock = perf_counter()
        parts = advance(step, now, dt, self._load)
        tally.seconds("structure", clock)
        state = self.cloth.state
        tally.volume(abs(state.volume / self.scene.liquid_volume - 1.0))
        tally.structure(after, state, converged=self.cloth.converged, steps=parts)
        if isinstance(step, DryStep):
            return None, 1, 0.0
        sample, shapes, residual = step.told()
        tally.statistics.wall_by_part["structure"] -= step.wall
        tally.statistics.wall_by_part["fluid"] += step.wall
        step.wall = 0.0
        tally.liquid(sample, shapes)
        return sample, shapes, residual

    def _advance_coupled(
        self, step: CoupledStep, now: float, after: float
    ) -> tuple[FlowSample, int, float]:
        outcome = step.advance(now, self.scene.time.step, self._load(after))
        for part, seconds in step.wall.items():
            self.tally.statistics.wall_by_part[part] += seconds
            step.wall[part] = 0.0
        self.tally.coupling(after, outcome)
        self.tally.structure(after, self.cloth.state, converged=self.cloth.converged, steps=1)
        return outcome.sample, outcome.iterations, outcome.residual

    def _load(self, time: float, *, at_rest: bool = False) -> HydrostaticLoad:
        shaking = np.zeros(3) if at_rest else self.motion.acceleration(time)
        return self.model.load(np.asarray(self.scene.gravity) - shaking)

    def _instant(self, time: float, liquid: LiquidSample | None) -> Instant:
        return instant_of(self.cloth, self.cloth.state, self._load(time), liquid, self.scene)

    def _sample(
        self, time: float, liquid: LiquidSample | None, iterations: int, residual: float
    ) -> Sample:
        state, metrics = self.cloth.state, self.energy.metrics(stored_in(self.cloth, liquid))
        pressures = still(len(state.position))
        if isinstance(self.step, PotentialStep):
            metrics |= liquid_metrics(liquid) | {"energy_removed": self.step.energy_removed}
            if liquid is not None:
                pressures = at_nodes(liquid, self.step.liquid.to_nodes(state.position).dot)
        elif isinstance(self.step, CoupledStep):
            assert liquid is None or isinstance(liquid, FlowSample)
            metrics |= flow_metrics(liquid, self.flow.non_orthogonality_max)
            if liquid is not None:
                pressures = at_nodes(liquid, self.mapping.to_nodes)
        return sample_at(
            time, state=state, triangles=self.cloth.triangles, radius=self.scene.tank.radius,
            load=self._load(time, at_rest=time == 0.0), gravity=np.asarray(self.scene.gravity),
            displacement=self.motion.displacement(time), flow=liquid, pressures=pressures,
            iterations=iterations, residual=residual, metrics=metrics,
        )  # fmt: skip

    def _text(self, iterations: int) -> str:
        if isinstance(self.step, DryStep):
            return ""
        mean = self.tally.statistics.iterations_total / max(self.tally.statistics.steps, 1)
        text = f"{iterations} iteration{'s'[: iterations > 1]}, mean {mean:.1f}"
        if self.tally.statistics.unconverged_steps:
            text += f", {self.tally.statistics.unconverged_steps} steps unconverged"
        return text

    def _write(self, sample: Sample) -> None:
        clock = perf_counter()
        self.results.append(sample)
        self.tally.seconds("output", clock)

    def _save(self, step: int) -> None:
        """Results first, then the checkpoint: it never knows more than they do."""
        clock = perf_counter()
        self.results.flush()
        parts: dict[str, dict[str, AnyArray]] = {
            "settled": self.settled, "structure": self.cloth.save(), "energy": self.energy.save(),
        }  # fmt: skip
        if isinstance(self.step, CoupledStep):
            parts["flow"] = self.flow.save()
            parts["scheme"] = self.step.scheme.save()
        if not isinstance(self.step, DryStep):
            parts["coupled"] = self.step.save()
        self.tally.seconds("output", clock)
        self.tally.statistics.wall_s = perf_counter() - self.clock
        attributes = {"step": step, "statistics": self.tally.statistics.to_dict()}
        checkpoint.save_checkpoint(self.folder / "checkpoint.h5", parts, attributes)

    def _guarded(self, body: Callable[[], None]) -> dict[str, Any]:
        """Run ``body`` and write the summary, however it ends."""
        try:
            body()
        except (RunFailed, ArithmeticError) as error:  # the latter from the diaphragm's own solver
            reason = str(error) if self.burst is None else f"{error} {self.burst}"
            _log.error("%s", reason)
            return self._finish("failed", reason)
        except KeyboardInterrupt:
            self._finish("interrupted", "interrupted by the user")
            raise
        return self._finish("completed", None)

    def _finish(self, status: str, error: str | None) -> dict[str, Any]:
        try:
            self.results.close()
        except RunFailed as failure:  # a full disk: what was flushed before stays readable
            status, error = "failed", error or str(failure)
        self.iterations.close()
        if isinstance(self.step, CoupledStep):
            self.flow.close()
        self.tally.statistics.wall_s = perf_counter() - self.clock
        results = read_results(self.folder)
        summary = summarise(results, self.tally.statistics, self.scene, status, error)
        write_json(self.folder / "summary.json", summary)
        return summary


@contextmanager
def _log_file(folder: Path) -> Iterator[None]:
    """Everything logged while it is open also goes to ``log.txt`` of ``folder``."""
    handler = logging.FileHandler(folder / "log.txt", encoding="utf-8")
    handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    ours = [logging.getLogger(name) for name in ("cloth", "coupling")]
    levels = [logger.level for logger in ours]
    for logger in ours:
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        for logger, level in zip(ours, levels, strict=True):
            logger.removeHandler(handler)
            logger.setLevel(level)
        handler.close()
