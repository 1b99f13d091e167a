"""All instants of the diaphragm in one VTKHDF file, which ParaView reads from 5.12 on.

An ``UnstructuredGrid`` with ``Steps`` as the VTKHDF format specification, version 2.0, has it: what
is over nodes or triangles stands instant after instant, and ``Steps`` says where each one begins.
The triangles stand there once.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np

from coupling.ports import Array
from coupling.store.atomic import replacing
from coupling.store.results import Results
from coupling.store.stored_rows import blocks

SUFFIX = ".vtkhdf"
AT_NODES = (
    "velocity", "contact_force", "pressure", "dynamic_pressure", "shell_pressure", "self_pressure",
    "shell_slip", "self_slip", "shell_work", "self_work",
)  # fmt: skip
AT_TRIANGLES = ("strain", "tension")
_VERSION = (2, 0)  # the first with steps
_KIND = b"UnstructuredGrid"
_TRIANGLE = 5  # VTK's number of this kind of cell


def write_instants(results: Results, path: Path) -> None:
    """Write every written instant of a run, of which there is at least one, with the times [s].

    Points [m] and what the nodes and triangles carry, in the units of ``results.h5`` and in double
    precision. Raises ``RunFailed`` where the file cannot be written.
    """
    with replacing(path) as part, h5py.File(part, "w") as file:
        grid = file.create_group("VTKHDF")
        grid.attrs["Version"] = _VERSION
        grid.attrs.create("Type", _KIND, dtype=h5py.string_dtype("ascii", len(_KIND)))
        _write_mesh(grid, results)
        _write_rows(grid, "Points", results.position)
        for group, names in (("PointData", AT_NODES), ("CellData", AT_TRIANGLES)):
            for name in names:
                _write_rows(grid, f"{group}/{name}", getattr(results, name))
        _write_steps(grid, results)


def _write_mesh(grid: Any, results: Results) -> None:
    """One piece, the same in every step: sizes and triangles."""
    triangles = results.triangles
    grid["NumberOfPoints"] = np.array([len(results.reference)])
    grid["NumberOfCells"] = np.array([len(triangles)])
    grid["NumberOfConnectivityIds"] = np.array([triangles.size])
    grid["Connectivity"] = triangles.ravel().astype(np.int64)
    grid["Offsets"] = np.arange(0, triangles.size + 1, 3)
    grid["Types"] = np.full(len(triangles), _TRIANGLE, dtype=np.uint8)


def _write_rows(grid: Any, name: str, rows: Array) -> None:
    """A series (T, k, ...) as a dataset (T k, ...), read and written in blocks."""
    times, entries = rows.shape[:2]
    dataset = grid.create_dataset(name, (times * entries, *rows.shape[2:]), np.float64)
    done = 0
    for (block,) in blocks(rows):
        dataset[done : done + len(block) * entries] = block.reshape(-1, *rows.shape[2:])
        done += len(block) * entries


def _write_steps(grid: Any, results: Results) -> None:
    """The times, and where in the datasets the nodes and triangles of each begin."""
    steps, number = grid.create_group("Steps"), np.arange(len(results.time))
    steps.attrs["NSteps"] = len(number)
    steps["Values"] = results.time
    steps["NumberOfParts"] = np.ones_like(number)
    steps["PartOffsets"] = np.zeros_like(number)
    steps["PointOffsets"] = number * len(results.reference)
    for name in ("CellOffsets", "ConnectivityIdOffsets"):
        steps[name] = np.zeros((len(number), 1), dtype=np.int64)
    for name in AT_NODES:
        steps[f"PointDataOffsets/{name}"] = number * len(results.reference)
    for name in AT_TRIANGLES:
        steps[f"CellDataOffsets/{name}"] = number * len(results.triangles)
