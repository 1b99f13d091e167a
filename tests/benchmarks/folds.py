"""Folds of a diaphragm at rest, on a grid that resolves them, against the elasto-gravity length.

python tests/benchmarks/folds.py [RINGS] [FILL_FRACTION] [STEPS] settles the tank of the thesis'
Table 5 with its rubber's own stiffness (47 rings of 15 mm, 0.3, 1000 pseudo steps: about ten
minutes), counts the folds of every ring that is folded (maxima of height that stand out by 5 mm),
prints them beside circumference / (2 pi (kappa/(rho g))^(1/4)), and draws folds.png beside this
file. The force that settling left is printed, over rho g R^3.
"""

# ruff: noqa: E402
from __future__ import annotations

import math
import sys
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from rich.console import Console
from rich.table import Table
from scipy.signal import find_peaks
from threadpoolctl import threadpool_limits

sys.path[0] = str(Path(__file__).parents[2])  # or cloth.py here would be taken for the package

from cloth.load import Settings
from cloth.material import diaphragm
from cloth.mesh import Mesh, hemisphere
from cloth.settle import settle
from cloth.shell.sphere import Sphere
from cloth.step import Cloth
from coupling.ports import Array, HydrostaticLoad

RADIUS, THICKNESS, DENSITY, GRAVITY = 0.4445, 1.778e-3, 1000.0, 9.81
STANDS_OUT = 5e-3  # m, of a fold
SHEET = diaphragm("AF-E-332", THICKNESS)
LENGTH = 2.0 * math.pi * (SHEET.bending_stiffness / (DENSITY * GRAVITY)) ** 0.25


def folds(mesh: Mesh, position: Array) -> list[tuple[float, float, int, float]]:
    """Of every ring: polar angle as moulded [deg], radius [m], folds, their height [m]."""
    polar = np.arccos(np.clip(mesh.points[:, 2] / RADIUS, -1.0, 1.0))
    found = []
    for angle in np.unique(np.round(polar, 6))[1:]:
        ring = np.flatnonzero(np.abs(polar - angle) < 1e-5)
        ring = ring[np.argsort(np.arctan2(mesh.points[ring, 1], mesh.points[ring, 0]))]
        height = position[ring, 2]
        peaks, _ = find_peaks(np.tile(height, 3), prominence=STANDS_OUT)
        count = int(np.sum((peaks >= len(ring)) & (peaks < 2 * len(ring))))
        radius = float(np.linalg.norm(position[ring, :2], axis=1).mean())
        found.append((math.degrees(angle), radius, count, float(np.ptp(height))))
    return found


def draw(mesh: Mesh, position: Array, path: Path) -> None:
    """The folded sheet from above and from the side."""
    figure = Figure(figsize=(9.0, 4.0))
    corner = position[mesh.triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-30)[:, None]
    light = 0.5 + 0.5 * normal @ np.array([0.42, 0.32, 0.85])
    for column, (elevation, turn) in enumerate(((90.0, -90.0), (35.0, -60.0))):
        axes = figure.add_axes((0.5 * column, 0.0, 0.5, 1.0), projection="3d")
        colours = matplotlib.colormaps["cividis"](light)
        axes.add_collection3d(Poly3DCollection(corner, facecolors=colours, edgecolors="none"))
        axes.set(xlim=(-0.3, 0.3), ylim=(-0.3, 0.3), zlim=(-0.55, 0.05))
        axes.view_init(elevation, turn)
        axes.set_box_aspect((1.0, 1.0, 1.0))
        axes.set_axis_off()
    figure.savefig(path, dpi=110)


def main(rings: int, fill_fraction: float, steps: int) -> None:
    """Settle, count, print and draw."""
    mesh = hemisphere(RADIUS, rings)
    cloth = Cloth(
        mesh=mesh, diaphragm=SHEET, shell=Sphere(RADIUS), compressive_stiffness=None,
        self_contact=True, settings=Settings(),
    )  # fmt: skip
    volume = fill_fraction * 4.0 / 3.0 * math.pi * RADIUS**3
    load = HydrostaticLoad(
        density=DENSITY, body_force=np.array([0.0, 0.0, -GRAVITY]), volume=volume
    )
    done = settle(cloth, load, steps_max=steps)
    position = cloth.state.position
    table = Table("moulded polar angle", "radius / R", "folds", "predicted there", "height mm")
    for angle, radius, count, height in folds(mesh, position):
        if count:
            predicted = 2.0 * math.pi * radius / LENGTH
            table.add_row(
                f"{angle:.0f}", f"{radius / RADIUS:.2f}", str(count), f"{predicted:.1f}",
                f"{1e3 * height:.0f}",
            )  # fmt: skip
    console = Console(width=100)
    console.print(table)
    console.print(
        f"{rings} rings of {500 * math.pi * RADIUS / rings:.1f} mm, {len(mesh.points)} nodes; "
        f"wavelength {1e3 * LENGTH:.0f} mm, {2 * math.pi * RADIUS / LENGTH:.1f} round the rim; "
        f"after {done.steps} steps the force left is {done.residual:.1e} of rho g R^3 "
        f"({'at rest' if done.converged else 'not at rest'})"
    )
    draw(mesh, position, Path(__file__).with_name("folds.png"))


if __name__ == "__main__":
    given = dict(enumerate(sys.argv[1:]))
    with threadpool_limits(1):
        main(int(given.get(0, 47)), float(given.get(1, 0.3)), int(given.get(2, 1000)))
