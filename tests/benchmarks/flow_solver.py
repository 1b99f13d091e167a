"""What a coupling iteration costs: restarts, the solver that stays alive, and no coupling at all.

python tests/benchmarks/flow_solver.py [CELLS ...] prints one table (default 1300 10000). A half
ball of liquid rocks about a level axis, which the stock pimpleFoam can do by itself, in one process
that writes nothing: the continuous run, the least that a step can cost. The other ways are given
the same points step by step. Times are the processors' own, of all processes, per step after the
first two; wall times besides. Both are of a shared machine: read their ratios.

With --solvers first (default sizes 1300 4400 9800 19700) it compares instead linear solvers,
tolerances and numbers of non-orthogonal correctors for p in the solver that stays alive: iterations
of p a step, and how far p is from that of residuals of 1e-13 and 8 correctors.
"""

# ruff: noqa: E402
from __future__ import annotations

import re
import resource
import sys
import tempfile
from pathlib import Path
from time import perf_counter, process_time

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

import numpy as np
from rich.console import Console
from rich.table import Table

from coupling.finite_volume.mesh import LiquidMesh, half_ball
from coupling.foam.case import Case
from coupling.foam.fields import read_cells, read_points
from coupling.foam.installation import find_openfoam
from coupling.foam.keepalive import case_of
from coupling.foam.process import OpenFoam, run_program
from coupling.ports import Array

RADIUS, VISCOSITY, STEP, STEPS = 0.4445, 1e-6, 0.005, 22
SWING, OMEGA = 5.0, 10.0  # [deg], [rad/s]
FIRST = 2  # steps that are not counted
ROCKING = f"""\
solidBodyCoeffs
{{
    solidBodyMotionFunction oscillatingRotatingMotion;
    oscillatingRotatingMotionCoeffs {{ origin (0 0 0); amplitude ({SWING} 0 0); omega {OMEGA}; }}
}}
"""


# For p and pcorr: solver, preconditioner or smoother, tolerance, non-orthogonal correctors.
SOLVERS = [
    ("PCG", "preconditioner DIC", "1e-13", 8),
    ("GAMG", "smoother GaussSeidel", "1e-11", 3),
    ("PCG", "preconditioner FDIC", "1e-11", 3),
    ("PCG", "preconditioner { preconditioner GAMG; smoother GaussSeidel; }", "1e-11", 3),
    ("GAMG", "smoother GaussSeidel", "1e-9", 3),
    ("PCG", "preconditioner FDIC", "1e-9", 3),
    ("PCG", "preconditioner FDIC", "1e-7", 3),
    ("PCG", "preconditioner FDIC", "1e-9", 2),
    ("PCG", "preconditioner FDIC", "1e-9", 1),
]


def rocked(points: Array, time: float) -> Array:
    """Points (P, 3) [m] at ``time`` [s]."""
    angle = np.radians(SWING * np.sin(OMEGA * time))
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[1, 0, 0], [0, c, s], [0, -s, c]]))


def processor_seconds() -> float:
    """Of this process and of all that it has waited for."""
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return process_time() + children.ru_utime + children.ru_stime


def stepped(case: Case, points: Array, repeats: int) -> tuple[float, float, Array]:
    """Processor and wall seconds of one call, and p at the end."""
    wall = []
    for number in range(STEPS):
        if number == FIRST:
            before = processor_seconds() + alive_seconds(case)
        target = rocked(points, (number + 1) * STEP)
        for _ in range(repeats):
            clock = perf_counter()
            pressure, _ = case.advance(number * STEP, (number + 1) * STEP, target)
            wall.append(perf_counter() - clock)
        if number:
            case.remove(number * STEP)
    spent = processor_seconds() + alive_seconds(case) - before
    case.close()
    return spent / (repeats * (STEPS - FIRST)), float(np.median(wall[FIRST * repeats :])), pressure


def alive_seconds(case: Case) -> float:
    """What a process that is still alive has used so far, on all processors."""
    if case.solver == "restart" or not case.log.is_file():
        return 0.0
    return case.openfoam.processors * execution_times(case.log)[-1]


def execution_times(log: Path) -> list[float]:
    """Processor seconds so far, after every step."""
    return [float(text) for text in re.findall(r"ExecutionTime = (\S+) s", log.read_text())]


def continuous(case: Case, openfoam: OpenFoam, points: Array) -> tuple[float, float, Array]:
    """Processor and wall seconds of one step, and p at the end, of the stock solver left alone."""
    motion = case.folder / "constant" / "dynamicMeshDict"
    motion.write_text(motion.read_text().split("solidBodyCoeffs")[0] + ROCKING)
    control = case.folder / "system" / "controlDict"
    control.write_text(re.sub(r"(writeInterval +)1;", rf"\g<1>{STEPS};", control.read_text()))
    end = f"{STEPS * STEP:.12g}"
    step = case.folder / "system" / "step"  # with the walls' library, where it is
    for name, value in (("endTime", end), ("deltaT", STEP)):
        step.write_text(re.sub(rf"{name} .*;", f"{name} {value};", step.read_text()))
    run_program(
        openfoam.solver, case.folder, openfoam=openfoam, log=case.log, timeout=1e4, moment="all"
    )
    found = read_points(case.folder / end / "polyMesh" / "points")
    assert np.abs(found - rocked(points, STEPS * STEP)).max() < 1e-12
    times = execution_times(case.log)
    spent = (times[-1] - times[FIRST - 1]) / (STEPS - FIRST)
    return spent, float("nan"), read_cells(case.folder / end / "p", case.mesh.cells)


def solvers(sizes: list[int]) -> None:
    """Print the table of linear solvers."""
    table = Table(
        "cells", "solver", "with", "tolerance", "correctors", "CPU ms", "of p", "p differs"
    )
    alive = find_openfoam(keep_alive=True)
    for cells in sizes:
        mesh, expected = half_ball(cells), np.zeros(0)
        for solver, helped, tolerance, correctors in SOLVERS:
            with tempfile.TemporaryDirectory() as folder:
                case = case_of(Path(folder) / "foam", mesh, openfoam=alive, timeout=1e4)
                case.create(RADIUS * mesh.points, viscosity=VISCOSITY)
                chosen = (
                    f"solver {solver}; {helped}; tolerance {tolerance}; relTol 0; maxIter 5000;"
                )
                settings = case.folder / "system" / "fvSolution"
                text = re.sub(
                    r'(pcorr\)\.\*"\s*{)[^}]*}', rf"\g<1> {chosen} }}", settings.read_text()
                )
                text = re.sub(r"(OrthogonalCorrectors +)\d+", rf"\g<1>{correctors}", text)
                settings.write_text(text)
                spent, _, pressure = stepped(case, RADIUS * mesh.points, 1)
                counts = re.findall(r"Solving for p, .*Iterations (\d+)", case.log.read_text())
            expected = expected if len(expected) else pressure
            table.add_row(
                str(mesh.cells), solver, helped.split(";")[0].split()[-1], tolerance,
                str(correctors), f"{1e3 * spent:.1f}", f"{sum(map(int, counts)) / STEPS:.0f}",
                f"{np.std(pressure - expected) / np.std(expected):.0e}",
            )  # fmt: skip
    Console(width=120).print(table)


def main(sizes: list[int]) -> None:
    """Print the table of the ways to take a step."""
    table = Table("cells", "way", "processor ms", "over continuous", "wall ms", "p differs")
    for cells in sizes:
        mesh: LiquidMesh = half_ball(cells)
        points = RADIUS * mesh.points
        stock, alive = find_openfoam(), find_openfoam(keep_alive=True)
        if alive.keep_alive is None:
            sys.exit("The solver that stays alive is not built: edt build-solver.")
        two = find_openfoam(keep_alive=True, processors=2)
        ways = {
            "continuous": (stock, 0),
            "alive": (alive, 1),
            "alive, every step twice": (alive, 2),
            "alive, two processors": (two, 1),
            "restart": (stock, 1),
        }
        for name, (openfoam, repeats) in ways.items():
            with tempfile.TemporaryDirectory() as folder:
                case = case_of(Path(folder) / "foam", mesh, openfoam=openfoam, timeout=1e4)
                case.create(points, viscosity=VISCOSITY)
                if repeats:
                    spent, wall, pressure = stepped(case, points, repeats)
                else:
                    spent, wall, pressure = continuous(case, openfoam, points)
                    least, expected = spent, pressure
            table.add_row(
                str(mesh.cells), name, f"{1e3 * spent:.1f}", f"{spent / least:.2f}",
                f"{1e3 * wall:.1f}" if repeats else "",
                f"{np.abs(pressure - expected).max() / np.abs(expected).max():.0e}",
            )  # fmt: skip
    Console(width=120).print(table)


if __name__ == "__main__":
    words = sys.argv[1:]
    if words[:1] == ["--solvers"]:
        solvers([int(word) for word in words[1:]] or [1300, 4400, 9800, 19700])
    else:
        main([int(word) for word in words] or [1300, 10000])
