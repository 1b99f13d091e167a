"""A sweep of 60 points: two workers against one, a killed worker, and a restart.

    python tests/benchmarks/sweep.py [--periods 2] [--rings 6]

The points are foam_cases/sway_map at ten frequencies and six fills, on ``hydrostatic`` and
``potential``, with fewer rings and periods: 120 runs of about half a second each, so that the
start of the workers weighs more than it does in earnest. Wall times are those of ``run_sweep``,
start and report included; the load is the machine's over the last minute, by all that runs on it.
"""

# ruff: noqa: E402
from __future__ import annotations

import argparse
import os
import sys
import tempfile
import threading
from pathlib import Path
from time import perf_counter
from typing import Any

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

import psutil

from coupling.campaign.sweep import run_sweep
from coupling.campaign.sweep_plan import Plan, parse_axis, plan_sweep

SCENE = Path(__file__).parents[2] / "foam_cases" / "sway_map"
OVER = ("motion.frequency=0.2:2:10:log", "liquid.fill_fraction=0.6:0.9:6")


def timed(name: str, plan: Plan, folder: Path, workers: int, *, kill_after: int = 0) -> float:
    """Sweep into ``folder`` and print a line; a worker is killed after ``kill_after`` runs."""
    before = {file: file.stat().st_mtime_ns for file in folder.glob("points/*/*/results.h5")}
    waiting = [kill_after] if kill_after else []

    def progress(stage: str, done: float, total: float, text: str) -> None:
        if waiting and done >= waiting[0]:
            waiting.clear()
            threading.Thread(target=worker_processes()[0].kill).start()

    begin = perf_counter()
    content = run_sweep(plan, folder, workers=workers, progress=progress)
    wall = perf_counter() - begin
    after = {file: file.stat().st_mtime_ns for file in folder.glob("points/*/*/results.h5")}
    stated = {
        "workers": workers,
        "wall s": f"{wall:.1f}",
        "points": len(content["rows"]),
        "failed": sum(bool(row["failure"]) for row in content["rows"]),
        "runs written": sum(before.get(file) != stamp for file, stamp in after.items()),
        "seconds in runs": f"{seconds_in(content):.0f}",
        "load": f"{os.getloadavg()[0]:.1f}",
    }
    print(f"| {name} | {' | '.join(map(str, stated.values()))} |", flush=True)
    return wall


def seconds_in(content: dict[str, Any]) -> float:
    """Wall time of all runs together [s]."""
    return sum(
        model["wall_s"] or 0.0 for row in content["rows"] for model in row["models"].values()
    )


def worker_processes() -> list[psutil.Process]:
    """Dask's workers below this process."""
    children = psutil.Process().children(recursive=True)
    return [child for child in children if any("spawn_main" in word for word in child.cmdline())]


def main() -> None:
    """Print one line a sweep, then the ratio."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--periods", type=float, default=2.0)
    parser.add_argument("--rings", type=int, default=6)
    given = parser.parse_args()
    changes = [f"time.periods={given.periods}", f"cloth.resolution={given.rings}"]
    axes = [parse_axis(text) for text in OVER]
    plan = plan_sweep(SCENE, changes, axes, ("hydrostatic", "potential"))
    heads = "workers | wall s | points | failed | runs written | seconds in runs | load"
    print(f"| sweep | {heads} |\n|{'---|' * 8}", flush=True)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        timed("first point, fills the caches", one_point(plan), folder / "first", 1)
        one = timed("one worker", plan, folder / "one", 1)
        two = timed("two workers", plan, folder / "two", 2)
        timed("two workers, one killed", plan, folder / "killed", 2, kill_after=30)
        timed("again, nothing to do", plan, folder / "killed", 2)
    print(f"\none worker over two: {one / two:.2f}")


def one_point(plan: Plan) -> Plan:
    """The first point alone."""
    return Plan(axes=plan.axes, models=plan.models, points=plan.points[:1])


if __name__ == "__main__":
    main()
