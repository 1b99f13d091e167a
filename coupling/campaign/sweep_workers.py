"""Runs in parallel on Dask: worker processes of this machine, or a cluster by its address.

The only module that knows Dask. It takes a second to import, so nothing imports it but a campaign
that has something to run.
"""

from __future__ import annotations

import fcntl
import logging
import os
import signal
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import dask
from distributed import Client, Future, LocalCluster, Worker, WorkerPlugin, as_completed
from distributed.scheduler import KilledWorker

from coupling.campaign.parallel import Task, no_more
from coupling.campaign.study import run_or_reuse
from coupling.campaign.sweep_plan import SweepError
from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene, with_overrides
from coupling.simulation.driver import run

_SETTINGS = {
    "distributed.scheduler.worker-saturation": 1.0,  # runs are long: none waits at a busy worker
    "distributed.comm.timeouts.connect": "60s",  # workers import for seconds on a busy machine
}
_ANSWER = 20.0  # seconds that a cluster has to answer


@contextmanager
def local_workers(count: int) -> Iterator[Client]:
    """``count`` worker processes of one thread each, ended with the block.

    A worker that dies is started again, and its run is tried again, four times in all. Memory is
    not limited. Workers end with this process, also when it is killed.
    """
    with (
        dask.config.set(_SETTINGS),
        LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            processes=True,
            memory_limit=0,
            dashboard_address="127.0.0.1:0",  # any free port, where others sweep as well
            silence_logs=logging.CRITICAL,
        ) as cluster,
        Client(cluster) as client,
    ):
        client.register_plugin(_LeaveInterrupts())
        yield client


@contextmanager
def cluster_at(address: str) -> Iterator[Client]:
    """A running cluster by its scheduler's ``address``; it has to see the same files.

    Its workers should have one thread each. Raises ``SweepError`` where none answers.
    """
    try:
        client = Client(address, timeout=_ANSWER)
    except (OSError, ValueError) as error:
        raise SweepError(
            f"--scheduler {address}: no answer: {error}. Give the address that `dask scheduler` "
            "prints, such as tcp://host:8786, or leave it out to run here."
        ) from error
    with client:
        if not client.nthreads():
            raise SweepError(f"--scheduler {address}: has no workers. Start some: dask worker.")
        yield client


def run_tasks(
    client: Client, tasks: Sequence[Task], more: Callable[[], Sequence[Task]] = no_more
) -> Iterator[tuple[Task, dict[str, Any]]]:
    """Each task with its run's summary, as they end; of a failure the status and the reason.

    A run that is complete in its folder is not repeated, one that was stopped goes on. After each
    result ``more`` says what is to be run as well.
    """
    futures: dict[Future[Any], Task] = {}

    def submitted(new: Sequence[Task]) -> list[Future[Any]]:
        begun = {
            client.submit(run_task, task.scene, task.folder, priority=task.cost, pure=False): task
            for task in sorted(new, key=lambda task: -task.cost)
        }
        futures.update(begun)
        return list(begun)

    ended = as_completed(submitted(tasks))
    for future in ended:
        yield futures.pop(future), outcome_of(future)
        ended.update(submitted(more()))


def outcome_of(future: Future[Any]) -> dict[str, Any]:
    """Summary that a run returned; where it raised or its workers died, a failure with why."""
    if future.status == "finished":
        summary: dict[str, Any] = future.result()
        return summary
    error = future.exception()
    if isinstance(error, KilledWorker):
        reason = (
            "the worker process died each time that this was run. "
            "Is there too little memory? See log.txt in the run's folder."
        )
    else:
        reason = f"{type(error).__name__}: {error}"
    return {"status": "failed", "error": reason}


def run_task(scene: Scene, folder: Path) -> dict[str, Any]:
    """Complete the run in ``folder``, within a worker; returns its summary."""
    _load_kernels(scene)
    folder.parent.mkdir(parents=True, exist_ok=True)
    return run_or_reuse(scene, folder, None)


_loaded: set[str] = set()


def _load_kernels(scene: Scene) -> None:
    """Have every kernel that ``scene`` needs compiled, by one process of a machine at a time.

    Numba keeps what it has compiled on disk: the first worker fills it, the others read.
    """
    fluid = FLUIDS[scene.model.fluid].kernels_of or scene.model.fluid
    if fluid in _loaded:
        return
    first_step = with_overrides(
        scene, [f"model.fluid={fluid}", f"time.duration={scene.time.step!r}", "time.settle=0"]
    )
    lock = Path(tempfile.gettempdir()) / f"diaphragm-tank-kernels-{os.getuid()}.lock"
    with lock.open("w") as file, tempfile.TemporaryDirectory() as folder:
        fcntl.flock(file, fcntl.LOCK_EX)  # falls with the process, however that ends
        run(first_step, Path(folder))
    _loaded.add(fluid)


class _LeaveInterrupts(WorkerPlugin):
    """Ctrl-C reaches every process of a terminal: the command alone acts on it."""

    def setup(self, worker: Worker) -> None:
        """Ignore the signal in a worker that starts."""
        signal.signal(signal.SIGINT, signal.SIG_IGN)
