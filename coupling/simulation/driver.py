"""The time loop: what a run computes, and what is kept of it however it ends."""

from __future__ import annotations

import logging
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from coupling.estimate.strength import burst_warning
from coupling.metrics.summary import summarise
from coupling.motion.record_summary import record_summary
from coupling.ports import AT_REST, RunFailed, StepReport
from coupling.scene.content import content_of
from coupling.scene.scene import SCENE_FILE, Scene, load_scene
from coupling.simulation.energy import EnergyBalance, stored_in
from coupling.simulation.interrupts import raise_lost_interrupt, wrapped_interrupts_raised
from coupling.simulation.mends import with_mend
from coupling.simulation.participants import Participants
from coupling.store.atomic import write_json
from coupling.store.iteration_log import IterationLog
from coupling.store.pace import Pace
from coupling.store.results import open_results
from coupling.store.results_writer import ResultsWriter
from coupling.store.resumption import SavedRun, save_run, saved_run
from coupling.store.run_log import process_settings, run_log
from coupling.store.run_record import SUMMARY, RunStatistics, Sample
from coupling.store.scene_file import write_scene

Progress = Callable[[str, float, float, str], None]
_CHECKPOINT_SHARE = 0.02  # of the wall time: a kill loses at most 50 times what one costs
_log = logging.getLogger(__name__)


def run(scene: Scene, folder: Path, *, progress: Progress | None = None) -> dict[str, Any]:
    """Settle the diaphragm, then shake the tank; results go to ``folder``.

    Returns what ``summary.json`` holds. A run that fails has the status ``failed`` and its reason
    there; what was computed is kept. KeyboardInterrupt passes through; the last
    checkpoint is where ``resume`` goes on.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with run_log(folder), process_settings:  # the log first: it marks the folder as a run's
        write_scene(scene, folder)
        return _Run(scene, folder, progress, None).from_start()


def resume(
    folder: Path, *, scene: Scene | None = None, progress: Progress | None = None
) -> dict[str, Any]:
    """Go on from the last checkpoint in ``folder``, or from the beginning before the first.

    As ``run``. ``scene``: that of the folder, if it is known already. A run that has finished is
    not computed again.

    Raises
    ------
    FolderError, UnreadableFile
        The folder's scene is not that of its checkpoint, or a file is damaged (``saved_run``).
    """
    scene = scene or load_scene(folder)
    saved = saved_run(folder, scene)
    if saved is not None and saved.finished is not None:
        return saved.finished
    if saved is None:
        shutil.rmtree(folder / "foam", ignore_errors=True)  # half made
    with run_log(folder), process_settings:
        one = _Run(scene, folder, progress, saved)
        return one.from_start() if saved is None else one.from_checkpoint(saved)


class _Run:
    """One run: its participants, the loop over their steps, and what is kept of it."""

    def __init__(
        self, scene: Scene, folder: Path, progress: Progress | None, saved: SavedRun | None
    ) -> None:
        self.scene, self.folder = scene, folder
        self.content = content_of(scene)
        self.progress = progress or (lambda *_: None)
        self.sides = Participants(scene, folder / "foam")
        self.tally = self.sides.tally
        self.energy = EnergyBalance(np.asarray(scene.gravity))
        self.burst = burst_warning(scene)
        self.results = self._begun_results() if saved is None else self._kept_results(saved)
        self.iterations = (
            IterationLog(folder) if saved is None else IterationLog.resume(folder, until=saved.time)
        )
        self.unwritten: Sample | None = None  # the last step, if that was no instant of output
        self.pace = Pace(_CHECKPOINT_SHARE)
        self.clock, self.cpu = perf_counter(), _cpu_time()

    def _begun_results(self) -> ResultsWriter:
        return ResultsWriter.create(
            self.folder, scene_toml=self._scene_as_written(), model=self.scene.model.fluid,
            reference=self.sides.cloth.reference, triangles=self.sides.cloth.triangles,
            scene_hash=self.content.digest(),
        )  # fmt: skip

    def _kept_results(self, saved: SavedRun) -> ResultsWriter:
        (self.folder / SUMMARY).unlink(missing_ok=True)  # of the part before
        return ResultsWriter.resume(
            self.folder, until=saved.last_output, steps_until=saved.time,
            scene_toml=self._scene_as_written(),
        )  # fmt: skip

    def from_start(self) -> dict[str, Any]:
        """The whole run; returns the summary."""
        return self._guarded(self._begin)

    def _scene_as_written(self) -> str:
        return (self.folder / SCENE_FILE).read_text(encoding="utf-8")  # its tables beside it

    def _begin(self) -> None:
        record = record_summary(self.scene)
        if record is not None:
            _log.info("%s.", record.says)
            for warning in record.warnings:
                _log.warning("%s", warning)
        if self.burst is not None:
            _log.warning("%s The run goes on with a sheet that cannot.", self.burst)
        if self.scene.time.beyond:
            _log.info("%s", self.scene.time.beyond)
        self.progress("settle", 0.0, 0.0, "the diaphragm sinks to its level")
        self.sides.settle()
        self.progress("settle", 0.0, 0.0, "settled")
        self.sides.start(self.iterations.write)
        self.energy.start(self.sides.instant(0.0, None), stored_in(self.sides.cloth, None))
        self._write(0.0, AT_REST, output=True)
        self._save(0)
        self._loop(0)

    def from_checkpoint(self, saved: SavedRun) -> dict[str, Any]:
        """The rest of the ``saved`` run; returns the summary."""
        self.tally.statistics = RunStatistics(**saved.statistics)
        self.clock -= self.tally.statistics.wall_s
        self.cpu -= self.tally.statistics.cpu_s

        def begin() -> None:
            self.energy.restore(saved.parts["energy"])
            self.sides.restore(saved.parts, self.iterations.write)
            self._loop(saved.step)

        return self._guarded(begin)

    def _loop(self, first: int) -> None:
        time = self.scene.time
        for step in range(first, time.steps):
            raise_lost_interrupt()
            now, after = step * time.step, (step + 1) * time.step
            report = self.sides.advance(now, after)
            liquid = report.sample
            work = 0.0 if liquid is None else liquid.pressure_work
            self.energy.add(time.step, self.sides.instant(after, liquid), work)
            self.tally.statistics.steps = step + 1
            self.tally.statistics.simulated_s = after
            output = (step + 1) % time.output_every == 0 or step + 1 == time.steps
            self._write(after, report, output=output)
            if self._checkpoint_due(step + 1):
                self._save(step + 1)
            self.progress("shake", after, time.end, self._text(report))

    def _checkpoint_due(self, step: int) -> bool:
        """Whether the state after so many steps is to be kept on the disk."""
        most = self.scene.time.checkpoint_every
        by_steps = most is not None and step % most == 0
        return step == self.scene.time.steps or by_steps or self.pace.due

    def _text(self, report: StepReport) -> str:
        if not report.samples:
            return ""
        mean = self.tally.statistics.iterations_total / max(self.tally.statistics.steps, 1)
        many = "s" if report.iterations > 1 else ""
        text = f"{report.iterations} iteration{many}, mean {mean:.1f}"
        if self.tally.statistics.unconverged_steps:
            text += f", {self.tally.statistics.unconverged_steps} steps unconverged"
        return text

    def _write(self, time: float, report: StepReport, *, output: bool) -> None:
        """Put the end of a step on record, and with ``output`` what is over nodes as well."""
        energies = self.energy.metrics(stored_in(self.sides.cloth, report.sample))
        sample = self.sides.sample(time, report, energies)
        clock = perf_counter()
        self.unwritten = None
        if output:
            self.results.append(sample)
            self.sides.write_fields()
        else:
            self.results.append(sample.at_step())
            self.unwritten = sample
        self.tally.seconds("output", clock)

    def _save(self, step: int) -> None:
        """Results first, then the checkpoint: it never knows more than they do."""
        clock = perf_counter()
        with self.pace.timed():
            self.results.flush()
            parts = self.sides.save() | {"energy": self.energy.save()}
            self._take_times()
            save_run(
                self.folder, self.content, step=step, rows=self.results.rows, parts=parts,
                statistics=self.tally.statistics.to_dict(),
            )  # fmt: skip
        self.tally.seconds("output", clock)

    def _take_times(self) -> None:
        self.tally.statistics.wall_s = perf_counter() - self.clock
        self.tally.statistics.cpu_s = _cpu_time() - self.cpu

    def _guarded(self, body: Callable[[], None]) -> dict[str, Any]:
        """Run ``body`` and write the summary, however it ends."""
        try:
            with wrapped_interrupts_raised():
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
            if self.unwritten is not None:  # the run ends here, before its time
                self.results.append_instant(self.unwritten)
            self.results.close()
        except RunFailed as failure:  # a full disk: what was flushed before stays readable
            status, error = "failed", error or str(failure)
        self.iterations.close()
        self.sides.close()
        self._take_times()
        results = open_results(self.folder)
        summary = summarise(results, self.tally.statistics, self.scene, status, error)
        write_json(self.folder / SUMMARY, summary)
        return summary


def _cpu_time() -> float:
    """CPU time [s] of this process and of all that it has started and seen end."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system
