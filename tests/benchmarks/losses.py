"""What dissipates in a run, by name, under the sheet's regularisations and the rubber's own losses.

python tests/benchmarks/losses.py [SCENE] [KEY=VALUE,KEY=VALUE ...] runs SCENE
(foam_cases/pad_sway_coarse) with the `potential` liquid, once as it is and once for every further
argument, a list of keys to set. It prints: amplitude and phase of the liquid's centre of gravity
along the sway; joules dissipated over the whole run, its ramp included, and of them the liquid's,
the stretch's, friction's on the shell and on itself, fold_damping's, slack_drag's and the rest
(impacts, snapping taut, the time step; negative: made); steps that had to be halved, and that
missed their tolerance; CPU seconds.
"""

# ruff: noqa: E402
from __future__ import annotations

import logging
import sys
import tempfile
from pathlib import Path
from time import process_time

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from coupling.metrics.energy import SHARES, rest
from coupling.scene.scene import load_scene
from coupling.simulation.driver import run
from coupling.store.results import read_results

CASES = Path(__file__).parents[2] / "foam_cases"
REAL = (
    "diaphragm.inextensible=false,diaphragm.loss_factor=0.15,"
    "diaphragm.friction_shell=0.3,diaphragm.friction_self=0.3"
)
SETS = (
    "cloth.fold_damping=28",
    "cloth.fold_damping=7",
    "cloth.fold_damping=5",
    "cloth.fold_damping=2",
    "cloth.fold_damping=1",
    "cloth.fold_damping=5,cloth.slack_drag=5",
    "diaphragm.friction_shell=0.3",
    "diaphragm.inextensible=false",
    "diaphragm.inextensible=false,diaphragm.loss_factor=0.15",
    REAL,
    f"{REAL},cloth.fold_damping=5",
    f"{REAL},cloth.fold_damping=2",
    f"{REAL},cloth.fold_damping=1",
    *(f"{REAL},cloth.fold_damping={damping},time.step=0.005" for damping in (14, 5, 2)),
)


class Halved(logging.Handler):
    """Counts the steps that are taken as two."""

    def __init__(self) -> None:
        super().__init__(logging.INFO)
        self.count = 0

    def emit(self, record: logging.LogRecord) -> None:
        self.count += "taken as two" in record.getMessage()


def row(scene: Path, keys: str) -> list[str]:
    """The figures of one run."""
    given = ["model.fluid=potential", "time.output_every=1", *keys.split(",")]
    clock, halved = process_time(), Halved()
    logging.getLogger("coupling.step.halving").addHandler(halved)
    with tempfile.TemporaryDirectory() as folder:
        summary = run(load_scene(scene, [key for key in given if key]), Path(folder))
        metrics = read_results(Path(folder)).metrics
    lost = [metrics[name][-1] for name in ("dissipated", *SHARES.values())] + [rest(metrics)[-1]]
    logging.getLogger("coupling.step.halving").removeHandler(halved)
    cg = summary["cg"]
    return [
        keys or "as it is",
        f"{1e3 * cg['amplitude_m'][0]:.2f} mm, {cg['phase_deg'][0]:.1f} deg",
        *(f"{joules:.2f}" for joules in lost),
        f"{halved.count}",
        f"{summary['coupling']['unconverged_steps']}",
        f"{process_time() - clock:.0f}",
    ]


def main() -> None:
    """Print the table."""
    scene, *sets = sys.argv[1:] or [str(CASES / "pad_sway_coarse")]
    table = Table(
        "set", "CG", "dissipated J", "liquid", "stretch", "shell", "self", "fold_damping",
        "slack_drag", "rest", "halved", "unconverged", "CPU s",
    )  # fmt: skip
    for keys in ("", *(sets or SETS)):
        figures = row(Path(scene), keys)
        print(*figures, sep=" | ", flush=True)
        table.add_row(*figures)
    Console(width=170).print(table)


if __name__ == "__main__":
    logging.getLogger("coupling.step.halving").setLevel(logging.INFO)
    with threadpool_limits(1):
        main()
