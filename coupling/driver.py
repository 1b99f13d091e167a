"""The time loop: what a run computes, and what is kept of it however it ends."""

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
from coupling.energy import EnergyBalance, stored_in
from coupling.iteration_log import IterationLog
from coupling.mends import with_mend
from coupling.metrics.summary import summarise
from coupling.participants import Participants
from coupling.ports import LiquidSample, RunFailed
from coupling.record_summary import record_summary
from coupling.results import ResultsWriter, read_results
from coupling.run_record import RunStatistics
from coupling.scene import SCENE_FILE, Scene, load_scene, write_scene
from coupling.strength import burst_warning
from coupling.structure import DryStep

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
    """One run: its participants, the loop over their steps, and what is kept of it."""

    def __init__(self, scene: Scene, folder: Path, progress: Progress | None) -> None:
        self.scene, self.folder = scene, folder
        self.progress = progress or (lambda *_: None)
        self.sides = Participants(scene, folder / "foam")
        self.tally = self.sides.tally
        self.energy = EnergyBalance(np.asarray(scene.gravity))
        self.burst = burst_warning(scene)
        self.clock = perf_counter()

    def from_start(self) -> dict[str, Any]:
        """The whole run; returns the summary."""
        written = (self.folder / SCENE_FILE).read_text(encoding="utf-8")  # its tables beside it
        self.results = ResultsWriter(
            self.folder, scene_toml=written, model=self.scene.model.fluid,
            reference=self.sides.cloth.reference, triangles=self.sides.cloth.triangles,
        )  # fmt: skip
        self.iterations = IterationLog(self.folder)
        return self._guarded(self._begin)

    def _begin(self) -> None:
        record = record_summary(self.scene)
        if record is not None:
            _log.info("%s.", record.says)
            for warning in record.warnings:
                _log.warning("%s", warning)
        if self.burst is not None:
            _log.warning("%s The run goes on with a sheet that cannot.", self.burst)
        self.progress("settle", 0.0, self.scene.time.settle, "the diaphragm sinks to its level")
        self.sides.settle()
        self.progress("settle", self.scene.time.settle, self.scene.time.settle, "settled")
        self.sides.start(self.iterations.write)
        self.energy.start(self.sides.instant(0.0, None), stored_in(self.sides.cloth, None))
        self._write(0.0, None, 0, 0.0)
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
            self.sides.restore(parts, self.iterations.write)
            self._loop(step)

        return self._guarded(begin)

    def _loop(self, first: int) -> None:
        time = self.scene.time
        for step in range(first, time.steps):
            now, after = step * time.step, (step + 1) * time.step
            liquid, iterations, residual = self.sides.advance(now, after)
            work = 0.0 if liquid is None else liquid.pressure_work
            self.energy.add(time.step, self.sides.instant(after, liquid), work)
            self.tally.statistics.steps = step + 1
            self.tally.statistics.simulated_s = after
            if (step + 1) % time.output_every == 0 or step + 1 == time.steps:
                self._write(after, liquid, iterations, residual)
            if (step + 1) % time.checkpoint_every == 0:
                self._save(step + 1)
            self.progress("shake", after, time.duration, self._text(iterations))

    def _text(self, iterations: int) -> str:
        if isinstance(self.sides.step, DryStep):
            return ""
        mean = self.tally.statistics.iterations_total / max(self.tally.statistics.steps, 1)
        text = f"{iterations} iteration{'s'[: iterations > 1]}, mean {mean:.1f}"
        if self.tally.statistics.unconverged_steps:
            text += f", {self.tally.statistics.unconverged_steps} steps unconverged"
        return text

    def _write(
        self, time: float, liquid: LiquidSample | None, iterations: int, residual: float
    ) -> None:
        energies = self.energy.metrics(stored_in(self.sides.cloth, liquid))
        sample = self.sides.sample(time, liquid, iterations, residual, energies)
        clock = perf_counter()
        self.results.append(sample)
        self.sides.write_fields()
        self.tally.seconds("output", clock)

    def _save(self, step: int) -> None:
        """Results first, then the checkpoint: it never knows more than they do."""
        clock = perf_counter()
        self.results.flush()
        parts = self.sides.save() | {"energy": self.energy.save()}
        self.tally.seconds("output", clock)
        self.tally.statistics.wall_s = perf_counter() - self.clock
        attributes = {"step": step, "statistics": self.tally.statistics.to_dict()}
        checkpoint.save_checkpoint(self.folder / "checkpoint.h5", parts, attributes)

    def _guarded(self, body: Callable[[], None]) -> dict[str, Any]:
        """Run ``body`` and write the summary, however it ends."""
        try:
            body()
        except (RunFailed, ArithmeticError) as error:  # the latter from the diaphragm's own solver
            reason = with_mend(error, self.scene, self.tally.statistics.flow_solver)
            reason = reason if self.burst is None else f"{reason} {self.burst}"
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
        self.sides.close()
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
