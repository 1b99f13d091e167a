"""The four coupling schemes on the same violent start: iterations, failures, wall time.

python tests/benchmarks/schemes.py [SECONDS] prints one table for the first SECONDS (default 0.2) of
foam_cases/pad_sway_coarse at the scene's own tolerance. Wall times are of one run on a shared
machine: read their ratios.
"""

# ruff: noqa: E402
from __future__ import annotations

import sys
import tempfile
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

from rich.console import Console
from rich.table import Table

from coupling.driver import run
from coupling.scene import load_scene

SCENE = Path(__file__).parents[2] / "foam_cases" / "pad_sway_coarse"
SCHEMES = ("added-mass", "iqn-ils", "aitken", "fixed-point")


def main(seconds: float) -> None:
    """Run the schemes one after the other and print the table."""
    table = Table("scheme", "steps", "mean", "max", "unconverged", "wall s", "ended")
    for scheme in SCHEMES:
        scene = load_scene(
            SCENE,
            [
                f'coupling.scheme="{scheme}"',
                f"time.duration={seconds}",
                "coupling.max_iterations=60",
                "coupling.max_unconverged=1000",
            ],
        )
        with tempfile.TemporaryDirectory() as folder:
            summary = run(scene, Path(folder))
        coupling = summary["coupling"]
        table.add_row(
            scheme,
            str(summary["steps"]),
            f"{coupling['iterations_mean']:.1f}",
            str(coupling["iterations_max"]),
            str(coupling["unconverged_steps"]),
            f"{summary['wall_s']:.0f}",
            summary["error"] or summary["status"],
        )
    Console(width=140).print(table)


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 0.2)
