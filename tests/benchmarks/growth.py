"""What a coupled step costs by part, and how that grows with the cells, as a markdown table.

    python -P tests/benchmarks/growth.py [CELLS ...] [--steps 6] [--inertia CELLS]
        [--set key=value ...]

The first steps of foam_cases/pad_sway_coarse (10 ms) on flow meshes of about CELLS cells, by
default 1216, 2300, 4320, 9728, 19600 and 43264, below one and the same cloth. Iterations: mean
(max); processor milliseconds a step, the first left out; the exponents are those of the cells
between the last three meshes. One BLAS and one Numba thread. ``exchange``: points and fields to and
from OpenFOAM; ``rest``: the scheme, balances, and what else is outside the parts. With
``--inertia`` the liquid's inertia is found on a mesh of that many cells, in place of the rule's, or
on the flow's own where that has no more. Ten minutes on two cores, half of it for the finest mesh.
"""

# ruff: noqa: E402
from __future__ import annotations

import argparse
import math
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from time import process_time
from typing import Any

for threads in ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[threads] = "1"
sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

from cloth.step import Cloth
from coupling.finite_volume.coarsening import coarsening
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.mesh_sizes import cells_made
from coupling.fluids.openfoam import step
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.foam.keepalive import AliveCase
from coupling.interface.free_patch import FreePatch
from coupling.interface.patch_map import PatchMap
from coupling.scene.scene import load_scene
from coupling.simulation.driver import _Run, run

SCENE = Path(__file__).parents[2] / "foam_cases" / "pad_sway_coarse"
SIZES = (1216, 2300, 4320, 9728, 19600, 43264)
PARTS = ("cloth", "operator", "map", "mesh", "closure", "output", "exchange", "rest", "OpenFOAM")
CALLS: tuple[tuple[str, type, tuple[str, ...]], ...] = (
    ("cloth", Cloth, ("begin_step", "solve", "accept_step")),
    ("operator", OpenFoamFlow, ("liquid_inertia",)),
    ("operator", PatchMap, ("rows_to_cloth",)),
    ("map", FreePatch, ("begin_step",)),
    ("map", PatchMap, ("to_flow", "to_cloth")),
    ("mesh", FollowingMesh, ("follow",)),
    ("closure", FollowingMesh, ("close_volume",)),
    ("exchange", AliveCase, ("advance",)),
    ("output", _Run, ("_write", "_save")),
)


class Clock:
    """Processor seconds of every part, what a part calls of another not counted twice."""

    def __init__(self) -> None:
        self.spent = dict.fromkeys(PARTS, 0.0)
        self._running, self._since = ["rest"], process_time()

    @contextmanager
    def timed(self, part: str) -> Iterator[None]:
        """Count what is done inside for ``part``."""
        self._turn()
        self._running.append(part)
        try:
            yield
        finally:
            self._turn()
            self._running.pop()

    def read(self) -> dict[str, float]:
        """Seconds of every part so far."""
        self._turn()
        return dict(self.spent)

    def _turn(self) -> None:
        now = process_time()
        self.spent[self._running[-1]] += now - self._since
        self._since = now

    def watch(self, part: str, owner: type, name: str) -> None:
        """Count every call of a method for ``part``."""
        method = getattr(owner, name)

        def timed(*given: Any, **named: Any) -> Any:
            with self.timed(part):
                return method(*given, **named)

        setattr(owner, name, timed)


CLOCK = Clock()


def solver_seconds(case: Path) -> float:
    """Processor seconds so far of the solver that stays alive in the ``case``."""
    logs = "".join(log.read_text() for log in case.glob("log.*Foam"))
    times = re.findall(r"ExecutionTime = (\S+) s", logs)
    return float(times[-1]) if times else 0.0


def measured(cells: int, steps: int, settings: list[str]) -> tuple[dict[str, float], str]:
    """Seconds a step of every part, and iterations a step: mean (max)."""
    scene = load_scene(SCENE, [
        f"openfoam.cells={cells}", f"time.duration={0.01 * steps}", "time.output_every=2",
        "time.checkpoint_every=1000", *settings,
    ])  # fmt: skip
    marks: list[dict[str, float]] = []
    with tempfile.TemporaryDirectory() as folder:

        def progress(phase: str, *_: object) -> None:
            if phase == "shake":  # once a step
                now = CLOCK.read() | {"OpenFOAM": solver_seconds(Path(folder) / "foam")}
                marks.append(now)

        summary = run(scene, Path(folder), progress=progress)
    if summary["status"] != "completed":
        sys.exit(f"{cells} cells: {summary['error']}")
    # The last step's mark comes after the checkpoint at the end, which no other has.
    first, last = marks[0], marks[-2]
    spent = {part: (last[part] - first[part]) / (len(marks) - 2) for part in PARTS}
    coupling = summary["coupling"]
    return spent, f"{coupling['iterations_mean']:.2f} ({coupling['iterations_max']})"


def exponent(sizes: list[int], values: list[float]) -> float:
    """Slope of log ``values`` over log ``sizes``, by least squares."""
    x, y = ([math.log(max(v, 1e-9)) for v in row] for row in (sizes, values))
    mean = sum(x) / len(x)
    return sum((a - mean) * b for a, b in zip(x, y, strict=True)) / sum((a - mean) ** 2 for a in x)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("cells", type=int, nargs="*", default=SIZES)
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--set", nargs="*", default=[], dest="settings")
    parser.add_argument("--inertia", type=int)
    given = parser.parse_args()
    if given.inertia is not None:
        most: int = given.inertia
        step.coarser_for = lambda mesh, _: (
            coarsening(mesh, half_ball(most)) if most < mesh.cells else None
        )
    for part, owner, names in CALLS:
        for name in names:
            CLOCK.watch(part, owner, name)
    columns = (*PARTS, "without OpenFOAM", "in all")
    print(f"| cells | iterations | {' | '.join(columns)} |\n|{'---|' * (len(columns) + 2)}")
    rows: list[list[float]] = []
    for cells in given.cells:
        spent, iterations = measured(cells, given.steps, given.settings)
        whole = sum(spent.values())
        rows.append([*spent.values(), whole - spent["OpenFOAM"], whole])
        figures = " | ".join(f"{1e3 * value:.0f}" for value in rows[-1])
        print(f"| {cells_made(cells)} | {iterations} | {figures} |", flush=True)
    if len(rows) > 2:
        sizes = [cells_made(cells) for cells in given.cells[-3:]]
        slopes = (exponent(sizes, list(column)) for column in zip(*rows[-3:], strict=True))
        print(f"| exponent | | {' | '.join(f'{slope:.1f}' for slope in slopes)} |")


if __name__ == "__main__":
    main()
