"""The least thickness that keeps a criterion, over the tank's radius: bracketed by runs."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from coupling.campaign.bracket import Trial, next_thicknesses, trials_left
from coupling.campaign.design_plan import DesignPlan
from coupling.campaign.design_rows import (
    curve_lines,
    design_json,
    radius_row,
    run_lines,
    run_row,
    trial_of,
)
from coupling.campaign.parallel import Summary, Task, in_parallel
from coupling.campaign.study import Progress, is_complete
from coupling.campaign.sweep_plan import POINTS
from coupling.campaign.sweep_rows import table_csv
from coupling.campaign.time_left import TimeLeft
from coupling.estimate.cost import run_cost
from coupling.report import write_report
from coupling.store.atomic import write_json, write_text
from coupling.store.run_record import read_summary

FILE, CURVE, RUNS = "design.json", "design.csv", "runs.csv"


def run_design(
    plan: DesignPlan,
    folder: Path | str,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Bracket the least thickness at every radius of ``plan``, into ``folder/points``.

    Radii go on side by side: each has its first thicknesses tried, then its bracket halved. A run
    that is complete in the folder is not repeated, so a search that was stopped goes on; what fails
    is tried again then, and a row with its reason. ``design.json``, ``design.csv`` and ``runs.csv``
    are written after every run, ``report.html`` at the end. ``workers``, ``scheduler`` and what is
    raised: as ``run_sweep``. Returns what ``design.json`` holds.
    """
    report = progress or (lambda *_: None)
    search = _Search(plan, Path(folder).resolve())
    first = search.due()
    left = TimeLeft()
    if first:
        report("design", search.done, search.expected, "starting the workers")
    for task, summary in in_parallel(first, workers, scheduler, search.due):
        search.add(task, summary)
        left.took(task.cost)
        remaining = left.text(task.cost * (search.expected - search.done))
        report(
            "design", search.done, search.expected, f"{task.point}: {summary['status']}{remaining}"
        )
    content = search.write()
    write_report(search.folder)
    return content


class _Search:
    """What was tried at each radius, and what is due."""

    def __init__(self, plan: DesignPlan, folder: Path) -> None:
        self.plan, self.folder = plan, folder
        self._tried: dict[float, dict[float, Trial]] = {radius: {} for radius in plan.radii}
        self._rows: dict[float, dict[float, dict[str, Any]]] = {one: {} for one in plan.radii}
        self._begun: dict[str, tuple[float, float]] = {}  # radius and thickness by the point's name

    def due(self) -> list[Task]:
        """Return the runs to start now; those that the folder holds are taken in instead."""
        tasks: list[Task] = []
        for radius, ends in zip(self.plan.radii, self.plan.ends, strict=True):
            tasks += self._due_at(radius, ends)
        return tasks

    def _due_at(self, radius: float, ends: tuple[float, float]) -> list[Task]:
        tried = self._tried[radius]
        tasks: list[Task] = []
        while not tasks:
            asked = next_thicknesses(tried, ends, self.plan.limit)
            new = [one for one in asked if (radius, one) not in self._begun.values()]
            if not new:
                break
            for thickness in new:
                task = self._task(radius, thickness)
                self._begun[task.point] = radius, thickness
                if is_complete(task.scene, task.folder):
                    self._keep(task, read_summary(task.folder))
                else:
                    tasks.append(task)
        return tasks

    def _task(self, radius: float, thickness: float) -> Task:
        point, model = self.plan.point(radius, thickness), self.plan.model
        scene = point.scenes[model]
        return Task(
            point=point.name, model=model, scene=scene, cost=run_cost(scene, model),
            folder=self.folder / POINTS / point.name / model,
        )  # fmt: skip

    def add(self, task: Task, summary: Summary) -> None:
        """Take in a run that has ended, and write the files."""
        self._keep(task, summary)
        self.write()

    def _keep(self, task: Task, summary: Summary) -> None:
        radius, thickness = self._begun[task.point]
        trial = trial_of(self.plan, task.scene, summary)
        self._tried[radius][thickness] = trial
        self._rows[radius][thickness] = run_row(task.point, task.scene, trial, self.plan.limit)

    @property
    def done(self) -> int:
        """Number of runs that have ended."""
        return sum(map(len, self._tried.values()))

    @property
    def expected(self) -> int:
        """Number of runs that it will take, as far as that is known now."""
        return self.done + sum(map(self._left, self.plan.radii, self.plan.ends))

    def _left(self, radius: float, ends: tuple[float, float]) -> int:
        return trials_left(self._tried[radius], ends, self.plan.limit)

    def write(self) -> dict[str, Any]:
        """Write the tables; return what ``design.json`` holds."""
        rows = [
            radius_row(
                radius,
                self._tried[radius],
                self._rows[radius],
                self.plan.limit,
                finished=not self._left(radius, ends),
            )
            for radius, ends in zip(self.plan.radii, self.plan.ends, strict=True)
        ]
        title = next(iter(self.plan.scan.points[0].scenes.values())).title
        content = design_json(self.plan, title, rows)
        write_json(self.folder / FILE, content)
        write_text(self.folder / CURVE, table_csv(curve_lines(content)))
        write_text(self.folder / RUNS, table_csv(run_lines(content)))
        return content
