"""Many scenes: a grid of them on several fluid models, in parallel, and restartable."""

from __future__ import annotations

import logging
import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from coupling.campaign.study import Progress, is_complete
from coupling.campaign.sweep_plan import POINTS, Plan, Point, SweepError
from coupling.campaign.sweep_rows import row_of, sweep_csv, sweep_json
from coupling.campaign.task import Task
from coupling.estimate.cost import run_cost
from coupling.fluids import FLUIDS
from coupling.report import write_report
from coupling.scene.scene import Scene
from coupling.store.atomic import write_json, write_text
from coupling.store.run_record import read_summary

FILE, TABLE = "sweep.json", "sweep.csv"
_log = logging.getLogger(__name__)

Summary = dict[str, Any]


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
    if waiting:
        report("sweep", total - len(waiting), total, "starting the workers")
    points = {point.name: point for point in plan.points}
    for task, summary in outcomes(_tasks(waiting, record.folder), workers, scheduler):
        record.add(points[task.point], task.model, summary)
        report("sweep", record.runs, total, f"{task.point}: {task.model} {summary.get('status')}")
    content = record.write()
    write_report(record.folder)
    return content


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
            self._rows[point.name] = row_of(point, self.folder / POINTS / point.name, ordered)

    def write(self) -> dict[str, Any]:
        """Write ``sweep.json`` and ``sweep.csv``; return what the former holds."""
        rows = [self._rows[point.name] for point in self.plan.points if point.name in self._rows]
        title = next(iter(self.plan.points[0].scenes.values())).title
        content = sweep_json(self.plan, title, rows)
        write_json(self.folder / FILE, content)
        write_text(self.folder / TABLE, sweep_csv(content))
        return content


def outcomes(
    tasks: Sequence[Task], workers: int | None, scheduler: str | None
) -> Iterator[tuple[Task, Summary]]:
    """Each of ``tasks`` with its run's summary, as they end, on worker processes or a cluster.

    ``workers``, ``scheduler``: as ``run_sweep``. Without tasks no worker is started.
    Raises ``SweepError`` where no cluster answers.
    """
    if not tasks:
        return
    try:
        from coupling.campaign.sweep_workers import cluster_at, local_workers, run_tasks
    except ValueError as error:  # Dask reads its settings when it is imported
        raise SweepError(f"{error}\nMend or remove that file.") from error

    count = min(workers or default_workers(task.scene for task in tasks), len(tasks))
    with cluster_at(scheduler) if scheduler else local_workers(count) as client:
        yield from run_tasks(client, tasks)


def _tasks(waiting: Sequence[tuple[Point, str]], folder: Path) -> list[Task]:
    """A point costs what all of its models do: the longest points go first, whole."""
    return [
        Task(
            point=point.name,
            model=model,
            scene=point.scenes[model],
            folder=folder / POINTS / point.name / model,
            cost=sum(run_cost(scene, name) for name, scene in point.scenes.items()),
        )
        for point, model in waiting
    ]


def default_workers(scenes: Iterable[Scene]) -> int:
    """Return how many workers to start: one a core, or fewer where a flow solver takes several."""
    cores = len(os.sched_getaffinity(0))
    taken = [FLUIDS[scene.model.fluid].cores(scene) for scene in scenes]
    return max(1, cores // max(taken, default=1))
