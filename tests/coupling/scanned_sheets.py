"""Sheets that scans are made of: a settled one with folds, a round bowl, a sphere."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import known_run
import numpy as np

from cloth.mesh import hemisphere
from coupling.ports import Array
from coupling.scans.sheet import Sheet
from coupling.store.results_writer import ResultsWriter

RADIUS = 0.4445
# The first instant of foam_cases/steady_shapes at a fill fraction of 0.3, in single precision.
SETTLED = Path(__file__).parent / "scans" / "settled_fill_30.npz"


def settled() -> Sheet:
    """A diaphragm at rest at a fill fraction of 0.3, with 12 folds."""
    with np.load(SETTLED) as kept:
        return Sheet(kept["position"].astype(float), kept["triangles"].astype(np.int64))


def bowl(depth: float = 0.12, order: float = 4.0) -> Sheet:
    """A bowl, r to the ``order``, ``depth`` [m] deep; of the fourth it determines all else."""
    mesh = hemisphere(RADIUS, 12)
    out = np.arccos(mesh.points[:, 2] / RADIUS) / (np.pi / 2)  # 1 at the rim
    plan = mesh.points[:, :2] / np.maximum(np.hypot(*mesh.points[:, :2].T), 1e-12)[:, None]
    nodes = np.column_stack([RADIUS * out[:, None] * plan, depth * (out**order - 1.0)])
    return Sheet(nodes, mesh.triangles)


def sphere() -> Sheet:
    """The hemisphere as moulded."""
    mesh = hemisphere(RADIUS, 12)
    return Sheet(mesh.points, mesh.triangles)


def write_run_of(folder: Path, sheet: Sheet, lifted: Array | None = None) -> None:
    """A run's folder whose first instant is the ``sheet``; ``lifted`` (3,) [m] more at the next."""
    mesh = hemisphere(RADIUS, 12)
    reference = mesh.points
    if len(reference) != len(sheet.nodes):
        with np.load(SETTLED) as kept:
            reference = kept["reference"].astype(float)
    writer = ResultsWriter.create(
        folder, scene_toml="", model="hydrostatic", reference=reference,
        triangles=sheet.triangles,
    )  # fmt: skip
    for time, moved in ((0.0, np.zeros(3)), (0.5, np.zeros(3) if lifted is None else lifted)):
        one = known_run.sample(time, reference, sheet.triangles)
        writer.append(replace(one, position=sheet.nodes + moved))
    writer.close()
