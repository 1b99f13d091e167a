"""The diaphragm's solver against the thesis' own, in one run: speed and error in one table.

python tests/benchmarks/cloth.py [SECONDS] [--growth RINGS ...] shakes the tank of the thesis' Table
5 (1.25 Hz, 0.25 m, fill fraction 0.8) with a hydrostatic liquid for SECONDS (default 4) and prints
for every solver: nodes; step; tolerance of a solve and its mean inner iterations; seconds of CPU
per simulated second, output left out; the error that the tolerance leaves, of the sheet, the rms
distance from where it is by a tenth of the least tolerance, over nodes and times, over R, and of
the first harmonic of the liquid's centre of gravity, |c - c'|/|c'|; the largest tensile strain and
the mean of its positive part; the worst error of the liquid's volume; the energy error; roundness
at rest; amplitude and phase of the centre of gravity. Both sheets, stiff and of the rubber's own
E t, are relaxed.
--growth: the same at one tolerance for sheets of several RINGS, with the exponent of the cost.
A second takes some 4 minutes of CPU.

Energy error: the kinetic energy that the solver's velocities say the sheet has at rest, over its
weight times the tank's radius; 0 would be exact. Roundness: largest over smallest radius of the
horizontal cut at 0.95 of the level's height, at rest. Where others use the machine too, even CPU
seconds vary, by their use of its caches: read ratios, within one table.
"""

# ruff: noqa: E402
from __future__ import annotations

import sys
from pathlib import Path

sys.path[0] = str(Path(__file__).parents[2])  # or this file would be taken for the package cloth

import argparse
import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from time import process_time

import numpy as np
from rich.console import Console
from rich.table import Table
from threadpoolctl import threadpool_limits

from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import hemisphere
from cloth.settle import settle
from cloth.shell.sphere import Sphere, level_of_fill_fraction
from cloth.step import Cloth
from cloth.thesis.grid import thesis_grid
from cloth.thesis.sheet import ThesisSheet
from coupling.interface.liquid_shape import liquid_cg
from coupling.metrics.harmonic import first_harmonic, last_whole_periods
from coupling.ports import Array, HydrostaticLoad
from coupling.scene.numerics import Cloth as ClothSection
from coupling.structure.diaphragm import BUCKLING
from coupling.verify.static_level import level_height, roundness

RADIUS, THICKNESS, FILL, DENSITY = 0.4445, 1.778e-3, 0.8, 1000.0
FREQUENCY, AMPLITUDE = 1.25, 0.25
VOLUME = FILL * 4.0 / 3.0 * math.pi * RADIUS**3
GRAVITY = np.array([0.0, 0.0, -9.81])
SHEET = diaphragm("AF-E-332", THICKNESS)
Loads = Callable[[float], HydrostaticLoad]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One solver's figures, as the module's text defines them."""

    cpu: float
    path: Array  # (steps, n, 3) [m]
    iterations: float
    strain_max: float
    strain_mean: float
    volume: float
    energy: float
    roundness: float
    swing: complex


def body_force(time: float) -> Array:
    """Gravity less the tank's acceleration (3,) [m/s^2]; rest before 0, a ramp of one period."""
    if time <= 0.0:
        return GRAVITY
    w, s = 2.0 * math.pi * FREQUENCY, min(time * FREQUENCY, 1.0)
    ramp = s**3 * (10.0 - 15.0 * s + 6.0 * s * s)
    rise = 30.0 * s**2 * (1.0 - s) ** 2 * FREQUENCY
    bend = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) * FREQUENCY**2
    sine, cosine = math.sin(w * time), math.cos(w * time)
    push = AMPLITUDE * (bend * sine + 2.0 * rise * w * cosine - ramp * w * w * sine)
    return GRAVITY - np.array([push, 0.0, 0.0])


def conserving(time: float) -> HydrostaticLoad:
    """Our liquid: its volume is kept."""
    return HydrostaticLoad(density=DENSITY, body_force=body_force(time), volume=VOLUME)


def fixed_datum(time: float) -> HydrostaticLoad:
    """The thesis' liquid: its datum is that of a free level."""
    b = body_force(time)
    level = (level_of_fill_fraction(FILL) - 1.0) * RADIUS
    datum = DENSITY * float(np.linalg.norm(b)) * level
    return HydrostaticLoad(density=DENSITY, body_force=b, datum=datum)


def shaken(cloth: Cloth | ThesisSheet, loads: Loads, step: float, seconds: float) -> Row:
    """Figures of ``seconds`` of the pad sway from the state that ``cloth`` is in."""
    rest = cloth.state.position
    level = level_height(FILL) * RADIUS
    energy = _energy_at_rest(cloth, loads, step)
    round_at_rest = roundness(rest, cloth.triangles, 0.95 * level)
    steps, cpu, zero = round(seconds / step), 0.0, np.zeros_like(rest)
    path, strain, volume, inner = [], [], [], []
    for k in range(steps):
        load = loads((k + 1) * step)
        clock = process_time()
        cloth.begin_step(step, load)
        cloth.solve(zero, alone=True)
        cloth.accept_step()
        cpu += process_time() - clock
        inner.append(cloth.iterations)
        state = cloth.state
        path.append(state.position)
        strain.append(np.maximum(state.strain, 0.0))
        volume.append(state.volume)
    times, shell = step * np.arange(1, steps + 1), Sphere(RADIUS)
    cg = np.array(
        [liquid_cg(x, cloth.triangles, shell, v) for x, v in zip(path, volume, strict=True)]
    )
    chosen, periods = last_whole_periods(times, FREQUENCY, start=1.0 / FREQUENCY)
    swing = first_harmonic(times[chosen], cg[chosen], FREQUENCY, periods=periods)
    return Row(
        cpu=cpu / seconds,
        path=np.array(path),
        iterations=float(np.mean(inner)),
        strain_max=float(np.max(strain)),
        strain_mean=float(np.mean(strain)),
        volume=float(np.max(np.abs(np.array(volume) / VOLUME - 1.0))),
        energy=energy,
        roundness=round_at_rest,
        swing=complex(1j * swing.coefficient[0]),  # against the tank, which moves as the sine
    )


def _energy_at_rest(cloth: Cloth | ThesisSheet, loads: Loads, step: float) -> float:
    """Mean kinetic energy over weight times radius [-] of 0.1 s at rest, from where it settled."""
    weight = float(cloth.mass.sum()) * float(np.linalg.norm(GRAVITY))
    energies = []
    for _ in range(round(0.1 / step)):
        cloth.begin_step(step, loads(0.0))
        cloth.solve(np.zeros_like(cloth.reference))
        cloth.accept_step()
        speed = cloth.state.velocity
        energies.append(0.5 * float(np.einsum("n,nd,nd->", cloth.mass, speed, speed)))
    return float(np.mean(energies)) / (weight * RADIUS)


def our_cloth(rings: int, tolerance: float, *, stiff: bool) -> Cloth:
    """Ours as moulded."""
    unit = DENSITY * float(np.linalg.norm(body_force(1.0 / FREQUENCY * 1.25))) * RADIUS**2
    return Cloth(
        mesh=hemisphere(RADIUS, rings), diaphragm=SHEET, shell=Sphere(RADIUS), self_contact=True,
        tensile_stiffness=ClothSection().stiffness * unit if stiff else None,
        compressive_stiffness=2.0 * BUCKLING * math.sqrt(SHEET.bending_stiffness * DENSITY * 9.81),
        settings=Settings(tolerance=tolerance, iterations=10_000),
    )  # fmt: skip


@cache
def at_rest(rings: int, *, stiff: bool) -> dict[str, Array]:
    """The state that ours settles in."""
    cloth = our_cloth(rings, 1e-5, stiff=stiff)
    settle(cloth, conserving(0.0))
    return cloth.save()


def our_row(
    rings: int, step: float, tolerance: float, seconds: float, *, stiff: bool = True
) -> tuple[int, Row]:
    """Nodes and figures of our solver, the sheet ``stiff`` or of the rubber's own E t."""
    cloth = our_cloth(rings, tolerance, stiff=stiff)
    cloth.restore(at_rest(rings, stiff=stiff))
    return len(cloth.mass), shaken(cloth, conserving, step, seconds)


def thesis_row(seconds: float, step: float) -> tuple[int, Row]:
    """Nodes and figures of the thesis' algorithm, in parts of 10 ms of its own ``step`` [s]."""
    cloth = ThesisSheet(
        grid=thesis_grid(RADIUS, 26), diaphragm=SHEET, shell=Sphere(RADIUS), step=step
    )
    cloth.begin_step(1.0, fixed_datum(0.0))
    cloth.solve(np.zeros_like(cloth.reference))
    cloth.accept_step()
    return len(cloth.mass), shaken(cloth, fixed_datum, 0.01, seconds)


def main() -> None:
    """Print the table."""
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("seconds", nargs="?", type=float, default=4.0)
    options.add_argument("--growth", nargs="+", type=int, metavar="RINGS")
    given = options.parse_args()
    our_row(6, 0.01, 1e-3, 1.7)  # compiles, and is not shown
    console = Console(width=170)
    table = growth(given.growth, given.seconds) if given.growth else errors(given.seconds)
    console.print(table)


def growth(resolutions: list[int], seconds: float) -> Table:
    """Sheets of several ``resolutions`` at one tolerance."""
    rows = [our_row(rings, 0.01, 1e-5, seconds) for rings in resolutions]
    (n, first), (m, last) = rows[0], rows[-1]
    slope = math.log(last.cpu / first.cpu) / math.log(m / n)
    each = slope - math.log(last.iterations / first.iterations) / math.log(m / n)
    table = _table(
        f"CPU grows as nodes^{slope:.2f} from {n} to {m} nodes, of an iteration as nodes^{each:.2f}"
    )
    for nodes, row in rows:
        _add(table, "stiff", nodes, 0.01, 1e-5, row, None)
    return table


def errors(seconds: float) -> Table:
    """Error against CPU of one grid at several steps and tolerances, and of other solvers."""
    table = _table("")
    nodes, row = thesis_row(seconds, 1e-3)
    _add(table, "the thesis'", nodes, 1e-3, None, row, None)
    for name, rings, step, tolerances in (
        ("stiff", 17, 0.02, (1e-4, 1e-5)),
        ("stiff", 17, 0.01, (1e-3, 1e-4, 1e-5, 1e-6)),
        ("stiff", 17, 0.005, (1e-4, 1e-5)),
        ("stiff", 24, 0.01, (1e-4, 1e-5)),
        ("rubber", 17, 0.01, (1e-4, 1e-5)),
    ):
        stiff = name == "stiff"
        exact = our_row(rings, step, 0.1 * min(tolerances), seconds, stiff=stiff)[1]
        for tolerance in tolerances:
            nodes, row = our_row(rings, step, tolerance, seconds, stiff=stiff)
            _add(table, name, nodes, step, tolerance, row, exact)
    return table


def _table(title: str) -> Table:
    return Table(
        "solver", "nodes", "step", "tolerance", "inner iterations", "CPU s/s",
        "error, sheet", "CG", "strain max", "mean", "volume", "energy", "roundness", "CG",
        title=title,
    )  # fmt: skip


def _add(
    table: Table, solver: str, nodes: int, step: float, tolerance: float | None, row: Row,
    exact: Row | None,
) -> None:  # fmt: skip
    left, moved = "", ""
    if exact is not None:
        distance = np.linalg.norm(row.path - exact.path, axis=2)
        left = f"{np.sqrt(np.mean(distance**2)) / RADIUS:.1e}"
        moved = f"{abs(row.swing - exact.swing) / abs(exact.swing):.1e}"
    table.add_row(
        solver, str(nodes), f"{1e3 * step:g} ms", "" if tolerance is None else f"{tolerance:g}",
        "" if tolerance is None else f"{row.iterations:.0f}", f"{row.cpu:.2f}",
        left, moved, f"{100 * row.strain_max:.2f} %",
        f"{100 * row.strain_mean:.3f} %", f"{row.volume:.0e}", f"{row.energy:.0e}",
        f"{row.roundness:.3f}",
        f"{abs(row.swing):.4f} m, {math.degrees(np.angle(row.swing)):.1f} deg",
    )  # fmt: skip


if __name__ == "__main__":
    with threadpool_limits(1):
        main()
