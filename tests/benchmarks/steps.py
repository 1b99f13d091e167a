"""Whole steps against steps in parts: error and CPU time of a violent sway.

    python -P tests/benchmarks/steps.py [--fluid potential] [--fill 0.5] [--rings 12]

Runs ``foam_cases/pad_sway_coarse`` on whole steps of 10, 5 and 2.5 ms and on steps of 10 ms with
several values of ``time.step_tolerance``, and prints a table against whole steps of 1.25 ms: the
first harmonic of the centre of gravity along the sway in the last period, and its path's rms
distance over the path's rms length. Some three minutes on one core.
"""

import argparse
import tempfile
from pathlib import Path
from time import process_time

import numpy as np

from coupling.scene.scene import load_scene
from coupling.simulation.driver import run
from coupling.store.results import read_results

SCENE = Path(__file__).parents[2] / "foam_cases" / "pad_sway_coarse"
EVERY = 0.02  # [s] between outputs
REFERENCE = (0.00125, None)
TRIED = (
    (0.01, None), (0.005, None), (0.0025, None), (0.01, 3e-3), (0.01, 1e-3), (0.01, 3e-4),
)  # fmt: skip


def path_of(step, tolerance, options):
    """Path (T, 3) [m] of the centre of gravity, its harmonic [m], parts and CPU time [s]."""
    changes = [
        f"model.fluid={options.fluid}", f"liquid.fill_fraction={options.fill}",
        f"cloth.resolution={options.rings}", f"time.step={step}",
        f"time.output_every={round(EVERY / step)}", "coupling.max_unconverged=1000",
        "coupling.max_unconverged_share=1.0",
    ]  # fmt: skip
    if tolerance is not None:
        changes.append(f"time.step_tolerance={tolerance}")
    scene = load_scene(SCENE, changes)
    with tempfile.TemporaryDirectory() as folder:
        clock = process_time()
        summary = run(scene, Path(folder))
        clock = process_time() - clock
        if summary["status"] != "completed":
            raise SystemExit(f"{step} s, {tolerance}: {summary['error']}")
        results = read_results(Path(folder))
    late = results.time >= results.time[-1] - scene.period - 1e-9
    turn = 2 * np.pi * results.time[late] / scene.period
    waves = np.stack([np.cos(turn), np.sin(turn), np.ones_like(turn)], axis=1)
    cosine, sine, _ = np.linalg.lstsq(waves, results.liquid_cg[late, 0], rcond=None)[0]
    return results.liquid_cg, cosine - 1j * sine, summary["halved_steps"], clock


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--fluid", default="potential")
    parser.add_argument("--fill", type=float, default=0.5)
    parser.add_argument("--rings", type=int, default=12)
    options = parser.parse_args()
    exact, wanted, _, clock = path_of(*REFERENCE, options)
    length = np.sqrt(np.sum((exact - exact[0]) ** 2))
    print("| step, ms | step_tolerance | steps in parts | CPU, s | harmonic, mm | error | path |")
    print("|---|---|---|---|---|---|---|")
    print(f"| {1e3 * REFERENCE[0]:g} | | | {clock:.1f} | {1e3 * abs(wanted):.2f} | | |")
    for step, tolerance in TRIED:
        path, found, parts, clock = path_of(step, tolerance, options)
        wrong = abs(found - wanted) / abs(wanted)
        away = np.sqrt(np.sum((path - exact) ** 2)) / length
        print(
            f"| {1e3 * step:g} | {tolerance or ''} | {parts} | {clock:.1f} | "
            f"{1e3 * abs(found):.2f} | {wrong:.2%} | {away:.2%} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
