"""The coupling schemes on pad sway: iterations, failures and wall time, as markdown tables.

    python tests/benchmarks/schemes.py [--seconds 0.2] [--long 1.6]
        [--tables steps,long,masses,tolerances]

``steps``: every scheme at three steps and two fills over the first SECONDS of
foam_cases/pad_sway_coarse, to the scene's own tolerance; ``long``: the added-mass scheme alone over
LONG seconds, to where the diaphragm is thrown about; ``masses``: every scheme with a diaphragm of
0.01 to 100 times its density, over SECONDS; ``tolerances``: the schemes at three tolerances and
three steps, over .1 s, .4 s and, where the first two of them get there, to the slam at .8 s, with
the CG's largest distance over its largest displacement from the first scheme's at the tightest.
Wall times are of one run on whatever else the machine does: read their ratios, which leave settling
out; the parts' shares have it in. All four take
hours where no solver has been built that stays alive.
"""

# ruff: noqa: E402
from __future__ import annotations

import argparse
import sys
import tempfile
from itertools import product
from pathlib import Path
from time import perf_counter
from typing import Any

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

import numpy as np

from coupling.ports import Array
from coupling.scene.scene import load_scene
from coupling.schemes import SCHEMES as LISTED
from coupling.simulation.driver import run
from coupling.store.results import read_results

SCENE = Path(__file__).parents[2] / "foam_cases" / "pad_sway_coarse"
SCHEMES = tuple(LISTED)
STEPS, FILLS = (0.01, 0.005, 0.0025), (0.8, 0.5)
TOLERANCES = 1e-6, 1e-4, 1e-3  # the tightest first, which the others are measured by
WINDOWS = (0.1, SCHEMES), (0.4, SCHEMES[:2]), (0.8, SCHEMES[:2])
DENSITY, FACTORS = 1070.0, (0.01, 0.1, 1.0, 10.0, 100.0)
MOVING = 1e-2  # of rho g R^3, left by settling: a sheet heavier than its liquid sinks on and on
PARTS = ("structure", "fluid", "mapping", "output")
COLUMNS = (
    "steps", "mean", "max", "unconverged", "wall ratio", *(f"{part} %" for part in PARTS), "ended",
)  # fmt: skip


def solved(scheme: str, seconds: float, *settings: str) -> dict[str, Any]:
    """Summary of the scene with ``scheme`` over ``seconds`` [s]."""
    scene = load_scene(
        SCENE,
        [
            f'coupling.scheme="{scheme}"',
            f"time.duration={seconds}",
            "coupling.max_iterations=60",
            "coupling.max_unconverged=1000",
            "coupling.max_unconverged_share=1.0",
            *settings,
        ],
    )
    clock: list[float] = []

    def progress(phase: str, *_: object) -> None:
        if phase == "shake":  # once a step
            clock.append(perf_counter())

    with tempfile.TemporaryDirectory() as folder:
        summary = run(scene, Path(folder), progress=progress)
        path = read_results(Path(folder)).liquid_cg
    pace = (clock[-1] - clock[0]) / (len(clock) - 1) if len(clock) > 1 else 0.0
    return summary | {"pace": pace, "path": path}


def head(*names: str) -> None:
    """Head of a table."""
    names = (*names, *COLUMNS)
    print(f"\n| {' | '.join(names)} |\n|{'---|' * len(names)}", flush=True)


def row(summary: dict[str, Any], wall: float, *names: object) -> None:
    """A run's row; ``wall`` [s] is a step's of the run that it is measured by."""
    coupling, spent = summary["coupling"], summary["wall_by_part"]
    ended = "completed" if summary["status"] == "completed" else summary["error"].split(". ")[0]
    whole = sum(spent.values()) or 1.0
    cells = (
        *names,
        summary["steps"],
        f"{coupling['iterations_mean']:.2f}",
        coupling["iterations_max"],
        coupling["unconverged_steps"],
        f"{summary['pace'] / wall:.1f}" if summary["pace"] and wall else "",
        *(f"{100 * spent[part] / whole:.0f}" for part in PARTS),
        ended,
    )
    print(f"| {' | '.join(map(str, cells))} |", flush=True)


def compared(seconds: float, settings: list[str], *names: object) -> None:
    """Every scheme's row; walls over that of the first."""
    first = None
    for scheme in SCHEMES:
        summary = solved(scheme, seconds, *settings)
        first = summary["pace"] if first is None else first
        row(summary, first, *names, scheme)


def strayed(path: Array, best: Array) -> str:
    """Largest distance of two paths (T, 3) over the largest displacement of the best, in %."""
    if path.shape != best.shape:
        return ""
    moved = np.linalg.norm(best - best[0], axis=1).max()
    return f"{100.0 * np.linalg.norm(path - best, axis=1).max() / moved:.2g}"


def tolerances() -> None:
    """Rows of iterations and answers by window, step, scheme and tolerance."""
    names = ("to s", "step ms", "scheme", "tolerance", "mean", "max", "unconverged", "CG off %")
    print(f"\n| {' | '.join((*names, 'ended'))} |\n|{'---|' * (len(names) + 1)}", flush=True)
    for seconds, schemes in WINDOWS:
        for step in STEPS:
            best: Array | None = None
            for scheme, tolerance in product(schemes, TOLERANCES):
                found = solved(
                    scheme, seconds, f"time.step={step}", f"coupling.tolerance={tolerance}",
                    "time.output_every=1", "cloth.tolerance=1e-7", "openfoam.cells=540",
                )  # fmt: skip
                best = found["path"] if best is None else best
                coupling, done = found["coupling"], found["status"] == "completed"
                cells = (
                    seconds, 1e3 * step, scheme, f"{tolerance:g}",
                    f"{coupling['iterations_mean']:.2f}", coupling["iterations_max"],
                    coupling["unconverged_steps"], strayed(found["path"], best),
                    "completed" if done else found["error"].split(". ")[0],
                )  # fmt: skip
                print(f"| {' | '.join(map(str, cells))} |", flush=True)


def main() -> None:
    """Print the tables asked for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=0.2)
    parser.add_argument("--long", type=float, default=1.6)
    parser.add_argument("--tables", default="steps,long,masses")
    given = parser.parse_args()
    if "steps" in given.tables:
        head("fill", "step ms", "scheme")
        for fill in FILLS:
            for step in STEPS:
                settings = [f"liquid.fill_fraction={fill}", f"time.step={step}"]
                compared(given.seconds, settings, fill, 1000 * step)
    if "long" in given.tables:
        head("fill", "step ms")
        for fill in FILLS:
            first = None
            for step in STEPS:
                settings = [f"liquid.fill_fraction={fill}", f"time.step={step}"]
                summary = solved("added-mass", given.long, *settings)
                first = summary["pace"] if first is None else first
                row(summary, first, fill, 1000 * step)
    if "tolerances" in given.tables:
        tolerances()
    if "masses" in given.tables:
        head("density", "scheme")
        for factor in FACTORS:
            heavier = [f"diaphragm.density={DENSITY * factor}", f"time.settle_tolerance={MOVING}"]
            compared(given.seconds, heavier, f"x {factor:g}")


if __name__ == "__main__":
    main()
