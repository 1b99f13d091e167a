"""Settles diaphragms from 10 to 50 % full, scans them, and holds the scans against them.

    python foam_cases/steady_shapes/shapes.py

Runs go to runs/steady_shapes, those that are there are taken; results.csv beside this file has for
each fill fraction and figure what is known, what was found as the mean over the scans, its standard
error, and by how many of these errors the scans are off, rms.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import meshio
import numpy as np

from coupling import compare_scan, read_results, run
from coupling.ports import Array, Ints
from coupling.scans.pose import Pose, determined, names_known
from coupling.scans.sheet import STEEPEST, Sheet
from foam_cases.steady_shapes.made_scan import NOISE, MadeScan, made_scan

HERE = Path(__file__).resolve().parent
FILLS = (0.1, 0.2, 0.3, 0.4, 0.5)
HALF = 0.5  # with its folds resolved the sheet did not settle in two minutes of CPU
SEEDS = range(4)
OUT = Path("runs") / "steady_shapes"
HEADS = ("fill_fraction", "figure", "known", "found", "standard_error", "off_rms")
MOTION = ("shift_x_m", "shift_y_m", "shift_z_m", "tilt_x_deg", "tilt_y_deg", "azimuth_deg")


def known_figures(nodes: Array, triangles: Ints) -> dict[str, float]:
    """What a scan with normal noise has, aligned, but for what the noise does at bends."""
    corner = nodes[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(normal, axis=1)
    upright = np.abs(normal[:, 2]) / area
    counted = upright > np.cos(np.radians(STEEPEST))
    square = np.average(upright[counted] ** -2.0, weights=area[counted])
    return {
        "vertical_mean_m": 0.0,
        "vertical_deviation_m": NOISE * float(np.sqrt(square)),
        "distance_mean_m": NOISE * float(np.sqrt(2.0 / np.pi)),
        "distance_rms_m": NOISE,
    }


def known_motion(scan: MadeScan, *, azimuth: bool) -> dict[str, float]:
    """The motion that takes a scan back; without an ``azimuth``, that which leaves the scan's."""
    pose = Pose(rotation=scan.rotation, shift=scan.shift)
    if not azimuth:
        back = Pose.turned(-pose.azimuth).rotation
        pose = Pose(rotation=back @ pose.rotation, shift=back @ pose.shift)
    values = [*pose.shift, *np.degrees(pose.tilt), np.degrees(pose.azimuth)]
    return dict(zip(MOTION, map(float, values), strict=True))


def compared(folder: Path) -> Iterator[tuple[str, float, dict[str, float]]]:
    """Name, known value, and figure with its error of every scan of the run in a ``folder``."""
    results = read_results(folder)
    nodes, triangles = results.position[0], results.triangles
    known, sheet = known_figures(nodes, triangles), Sheet(nodes, triangles)
    size = float(np.linalg.norm(nodes, axis=1).max())
    basis = determined(sheet, sheet.match(nodes), nodes, size)
    for seed in SEEDS:
        # what a rotation that is not determined leaves is not known beforehand
        level = np.array([np.cos(seed), np.sin(seed), 0.0])
        axis = None if names_known(basis)["azimuth"] else level
        scan, file = made_scan(nodes, triangles, seed, axis=axis), folder / f"scan_{seed}.ply"
        meshio.Mesh(1e3 * scan.points, []).write(file)
        done = compare_scan(file, folder, "mm", out=folder / f"compared_{seed}")
        found: dict[str, Any] = {**done.table["aligned"]["figures"], **done.table["alignment"]}
        motion = known_motion(scan, azimuth=found["azimuth_deg"] is not None)
        for name, value in {**known, **motion}.items():
            if found[name] is not None:
                yield name, value, found[name]


def main() -> None:
    """Settle, scan, compare, and write the table."""
    rows = []
    for fill in FILLS:
        folder = OUT / f"fill_{round(100 * fill)}"
        if not (folder / "summary.json").is_file():
            changes = {"liquid.fill_fraction": fill}
            if fill == HALF:
                changes["cloth.wrinkling"] = "relaxed"
            run(HERE, folder, changes=changes)
        by_name: dict[str, list[tuple[float, float, float]]] = {}
        for name, known, found in compared(folder):
            by_name.setdefault(name, []).append((known, found["value"], found["standard_error"]))
        for name, values in by_name.items():
            known, value, error = np.array(values).T
            off = float(np.sqrt(np.mean(((value - known) / error) ** 2)))
            if name in MOTION:  # each scan has a motion of its own
                value, known = value - known, 0.0 * known
            found_row = (known.mean(), value.mean(), error.mean(), off)
            rows.append((fill, name, *(f"{one:.4g}" for one in found_row)))
    with (HERE / "results.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([HEADS, *rows])


if __name__ == "__main__":
    main()
