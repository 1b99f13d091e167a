"""Many scenes: a grid of them on several fluid models, in parallel, and restartable."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from coupling.campaign.parallel import Summary, Task, in_parallel
from coupling.campaign.study import Progress, is_complete
from coupling.campaign.sweep_plan import POINTS, Plan, Point
from coupling.campaign.sweep_rows import row_of, sweep_csv, sweep_json
from coupling.campaign.time_left import TimeLeft
from coupling.estimate.cost import run_cost
from coupling.report import write_report
from coupling.store.atomic import write_json, write_text
from coupling.store.run_record import read_summary

FILE, TABLE = "sweep.json", "sweep.csv"
_log = logging.getLogger(__name__)


def run_sweep(
    plan: Plan,
    folder: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run every point of ``plan`` on each of its models, into ``folder/points/<point>/<model>``.

    ``workers``: processes, one for each core if left out; ``scheduler``: address of a running Dask
    cluster in their place. The longest points start first. A run that is complete in the folder is
    not repeated, so a sweep that was stopped goes on; one that failed is tried again. What fails
    is a row with its reason. ``sweep.json`` and ``sweep.csv`` are written after every point,
    ``report.html`` at the end. Returns what ``sweep.json`` holds.

    Raises ``SweepError`` where no cluster answers, ``RunFailed`` where ``folder`` is not writable.
    """
    report = progress or (lambda *_: None)
    record = _Record(plan, Path(folder).resolve())
    total = len(plan.points) * len(plan.models)
    waiting = record.take_finished()
    left, to_come = TimeLeft(), sum(map(_cost, waiting))
    if waiting:
        report("sweep", total - len(waiting), total, "starting the workers")
    for point, model, summary in _outcomes(plan, waiting, record.folder, workers, scheduler):
        record.add(point, model, summary)
        cost = _cost((point, model))
        left.took(cost)
        to_come -= cost
        text = f"{point.name}: {model} {summary.get('status')}{left.text(to_come)}"
        report("sweep", record.runs, total, text)
    content = record.write()
    write_report(record.folder)
    return content


def _cost(run: tuple[Point, str]) -> float:
    point, model = run
    return run_cost(point.scenes[model], model)


class _Record:
    """What is known so far; written whenever a point is complete."""

    def __init__(self, plan: Plan, folder: Path) -> None:
        self.plan, self.folder = plan, folder
        self.runs = 0
        self._summaries: dict[str, dict[str, Summary]] = {point.name: {} for point in plan.points}
        self._rows: dict[str, dict[str, Any]] = {}

    def take_finished(self) -> list[tuple[Point, str]]:
        """Take over the runs that the folder holds; returns those that are still to do."""
        waiting = []
        for point in self.plan.points:
            for model, scene in point.scenes.items():
                there = self.folder / POINTS / point.name / model
                if is_complete(scene, there):
                    self._keep(point, model, read_summary(there))
                else:
                    waiting.append((point, model))
        return waiting

    def add(self, point: Point, model: str, summary: Summary) -> None:
        """Take in a run that has ended; write the files where it completes its point."""
        self._keep(point, model, summary)
        if point.name in self._rows:
            self.write()

    def _keep(self, point: Point, model: str, summary: Summary) -> None:
        self.runs += 1
        known = self._summaries[point.name]
        known[model] = summary
        if len(known) == len(self.plan.models):
            ordered = {name: known[name] for name in self.plan.models}
            place = self.folder / POINTS / point.name
            self._rows[point.name] = row_of(point, place, ordered, self.plan.wanted)

    def write(self) -> dict[str, Any]:
        """Write ``sweep.json`` and ``sweep.csv``; return what the former holds."""
        rows = [self._rows[point.name] for point in self.plan.points if point.name in self._rows]
        title = next(iter(self.plan.points[0].scenes.values())).title
        content = sweep_json(self.plan, title, rows)
        write_json(self.folder / FILE, content)
        write_text(self.folder / TABLE, sweep_csv(content))
        return content


def _outcomes(
    plan: Plan,
    waiting: list[tuple[Point, str]],
    folder: Path,
    workers: int | None,
    scheduler: str | None,
) -> Iterator[tuple[Point, str, Summary]]:
    points = {point.name: point for point in plan.points}
    tasks = [
        Task(
            point=point.name,
            model=model,
            scene=point.scenes[model],
            folder=folder / POINTS / point.name / model,
            cost=sum(run_cost(scene, name) for name, scene in point.scenes.items()),
        )
        for point, model in waiting
    ]
    for task, summary in in_parallel(tasks, workers, scheduler):
        yield points[task.point], task.model, summary
