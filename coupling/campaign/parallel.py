"""Runs of a campaign in parallel; what is run next may depend on what has ended.

Dask, which does the work, is imported when there is something to run.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from coupling.campaign.sweep_plan import SweepError
from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene

Summary = dict[str, Any]


@dataclass(frozen=True, kw_only=True)
class Task:
    """One run of a campaign: ``scene`` in ``folder`` (absolute); the largest ``cost`` is first."""

    point: str
    model: str
    scene: Scene
    folder: Path
    cost: float


def no_more() -> Sequence[Task]:
    """Return no further tasks."""
    return ()


def in_parallel(
    tasks: Sequence[Task],
    workers: int | None,
    scheduler: str | None,
    more: Callable[[], Sequence[Task]] = no_more,
) -> Iterator[tuple[Task, Summary]]:
    """Each task with its run's summary, as they end; nothing is started without any.

    ``workers``: processes, one for each core if None; ``scheduler``: address of a Dask cluster in
    their place. ``more`` is called after each result was taken in, and returns further tasks.

    Raises ``SweepError`` where no cluster answers, or Dask cannot read its settings.
    """
    if not tasks:
        return
    try:
        from coupling.campaign.sweep_workers import cluster_at, local_workers, run_tasks
    except ValueError as error:  # Dask reads its settings when it is imported
        raise SweepError(f"{error}\nMend or remove that file.") from error

    count = min(workers or default_workers(task.scene for task in tasks), len(tasks))
    with cluster_at(scheduler) if scheduler else local_workers(count) as client:
        yield from run_tasks(client, tasks, more)


def default_workers(scenes: Iterable[Scene]) -> int:
    """Return how many workers to start: one a core, or fewer where a flow solver takes several."""
    cores = len(os.sched_getaffinity(0))
    taken = [FLUIDS[scene.model.fluid].cores(scene) for scene in scenes]
    return max(1, cores // max(taken, default=1))
