"""What `edt check` foresees of a run's time and memory against what it takes, as markdown tables.

    python -P tests/benchmarks/foreseen.py [NAME ...] [--results FILE]

Every scene runs over some steps in a process of its own with one thread. Times are CPU seconds of
that process and of the flow's solver, which other programs disturb less than wall times: settling,
a step (the mean over all of them), and the whole, without imports. Memory is the most that both
held in RAM together. The second table has, by part, what each constant of ``estimate.cost`` and of
the fluid models would have to be multiplied by. Takes a quarter of an hour on free cores;
``--results`` keeps what was measured, and goes on from there.
"""

# ruff: noqa: E402
from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
sys.path[0] = str(ROOT)  # or cloth.py here would be taken for the package
for name in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

from resource import RUSAGE_CHILDREN, RUSAGE_SELF, getrusage

from coupling.estimate.cost import run_cost, run_memory, start_cost, step_cost
from coupling.estimate.machine import slowness
from coupling.scene.scene import Scene, load_scene
from coupling.simulation.driver import run

# name: case, changes, steps
SCENES = {
    "datum, 16 rings": ("pad_sway_coarse", "model.fluid=datum", 100),
    "hydrostatic, 8 rings": (
        "pad_sway_coarse", "model.fluid=hydrostatic cloth.resolution=8", 100,
    ),
    "hydrostatic, 24 rings": ("pad_sway", "model.fluid=hydrostatic cloth.resolution=24", 100),
    "hydrostatic, 40 rings": (
        "pad_sway_coarse", "model.fluid=hydrostatic cloth.resolution=40", 40,
    ),
    "hydrostatic, folds resolved, 24 rings": (
        "pad_sway_coarse", "model.fluid=hydrostatic cloth.wrinkling=resolved cloth.resolution=24 "
        "diaphragm.thickness=0.004 time.settle_tolerance=1e-2", 20,
    ),
    "hydrostatic, folds resolved, 42 rings": (
        "pad_sway_coarse", "model.fluid=hydrostatic cloth.wrinkling=resolved cloth.resolution=42 "
        "time.settle_tolerance=1e-2", 20,
    ),
    "potential, 8 rings": ("pad_sway_coarse", "model.fluid=potential cloth.resolution=8", 100),
    "potential, 16 rings": ("pad_sway_coarse", "model.fluid=potential", 100),
    "potential, 24 rings": ("pad_sway", "model.fluid=potential cloth.resolution=24", 40),
    "openfoam, 540 cells, 10 rings": (
        "pad_sway_coarse", "openfoam.cells=540 cloth.resolution=10", 20,
    ),
    "openfoam, 1216 cells, 16 rings": ("pad_sway_coarse", "", 20),
    "openfoam, 4320 cells, 24 rings": (
        "pad_sway_coarse", "openfoam.cells=4320 cloth.resolution=24", 8,
    ),
    # No constant was fitted to these.
    "slosh, potential, 12 rings": ("slosh", "model.fluid=potential", 60),
    "whole sway, hydrostatic, 12 rings": (
        "pad_sway_coarse", "model.fluid=hydrostatic cloth.resolution=12", 160,
    ),
    "half full, potential, 20 rings": (
        "pad_sway_coarse", "model.fluid=potential cloth.resolution=20 liquid.fill_fraction=0.5", 40,
    ),
    "openfoam, 2300 cells, 18 rings": ("pad_sway", "", 12),
    "whole sway, openfoam, 540 cells, 10 rings": (
        "pad_sway_coarse", "openfoam.cells=540 cloth.resolution=10", 160,
    ),
}  # fmt: skip


def scene_of(name: str) -> Scene:
    """The scene, as long as it is run here."""
    case, changes, steps = SCENES[name]
    scene = load_scene(ROOT / "foam_cases" / case, changes.split())
    time = scene.time.model_copy(update={"duration": steps * scene.time.step})
    return scene.model_copy(update={"time": time})


def cpu() -> float:
    """CPU seconds of this process and of all that it started, also of what still runs."""
    own, ended = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    total = own.ru_utime + own.ru_stime + ended.ru_utime + ended.ru_stime
    parents, ticks = {}, {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # ended meanwhile
            fields = stat.read_text().rpartition(")")[2].split()
            pid = int(stat.parent.name)
            parents[pid], ticks[pid] = int(fields[1]), sum(map(int, fields[11:15]))
    below = {os.getpid()}
    while more := {pid for pid, parent in parents.items() if parent in below} - below:
        below |= more
    return total + sum(ticks[pid] for pid in below - {os.getpid()}) / os.sysconf("SC_CLK_TCK")


def measured(name: str) -> dict[str, float]:
    """CPU seconds and bytes that the scene takes in this process and those it starts."""
    scene, clock = scene_of(name), []

    def progress(*_: object) -> None:  # before settling, after it, and after every step
        clock.append(cpu())

    with tempfile.TemporaryDirectory() as folder:
        summary = run(scene, Path(folder), progress=progress)
    own, children = getrusage(RUSAGE_SELF), getrusage(RUSAGE_CHILDREN)
    steps = len(clock) - 3
    return {
        "settling": clock[1] - clock[0],
        "start": clock[2] - clock[1] - (clock[-1] - clock[2]) / steps,
        "step": (clock[-1] - clock[2]) / steps,
        "total": clock[-1] - clock[0],
        "bytes": 1024.0 * (own.ru_maxrss + children.ru_maxrss),
        "slowness": slowness(),
        "cloth_iterations": summary["cloth"]["iterations_mean"],
        "iterations": summary["coupling"]["iterations_mean"],
    }


def in_a_process(name: str) -> dict[str, float]:
    """``measured`` of a process of its own; its second run counts, when all is compiled."""
    done = subprocess.run(
        [sys.executable, "-P", __file__, "--one", name], check=True, stdout=subprocess.PIPE
    )
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def tables(found: dict[str, dict[str, float]]) -> str:
    """Foreseen beside measured."""
    lines = [
        "| scene | time foreseen, s | taken, s | over | memory foreseen, MB | taken, MB | over |",
        "|---|---|---|---|---|---|---|",
    ]
    parts = [
        "| scene | before the first step, s | over | a step, ms | over |",
        "|---|---|---|---|---|",
    ]
    slow = min(row["slowness"] for row in found.values())  # as ``remember_speed`` keeps it
    for name, row in found.items():
        scene = scene_of(name)
        fluid = scene.model.fluid
        time, memory = slow * run_cost(scene, fluid), run_memory(scene, fluid)
        lines.append(
            f"| {name} | {time:.3g} | {row['total']:.3g} | {time / row['total']:.2f} "
            f"| {1e-6 * memory:.0f} | {1e-6 * row['bytes']:.0f} | {memory / row['bytes']:.2f} |"
        )
        start, step = slow * start_cost(scene, fluid), slow * step_cost(scene, fluid)
        taken = row["settling"] + row.get("start", 0.0)
        parts.append(
            f"| {name} | {taken:.3g} | {start / taken:.2f} "
            f"| {1e3 * row['step']:.3g} | {step / row['step']:.2f} |"
        )
    return "\n".join([*lines, "", *parts])


def main() -> None:
    """Measure what is asked for, and print both tables."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("names", nargs="*", default=list(SCENES))
    parser.add_argument("--results", type=Path)
    parser.add_argument("--one", action="store_true", help="print the figures of one as JSON")
    options = parser.parse_args()
    if options.one:
        print(json.dumps(measured(options.names[0])))
        return
    found: dict[str, Any] = {}
    if options.results and options.results.is_file():
        found = json.loads(options.results.read_text())
    for name in options.names:
        if name not in found:
            found[name] = in_a_process(name)
            if options.results:
                options.results.write_text(json.dumps(found, indent=1))
    print(tables(found))


if __name__ == "__main__":
    main()
