"""The diaphragm at an instant as a surface for other programs: PLY and STL."""

from __future__ import annotations

from pathlib import Path

import meshio
import numpy as np

from coupling.ports import RunFailed
from coupling.store.atomic import replacing
from coupling.store.results import Results

FORMATS = {".ply": "ply", ".stl": "stl"}
_SCALARS = (
    "pressure", "dynamic_pressure", "shell_pressure", "self_pressure", "shell_slip", "self_slip",
    "shell_work", "self_work",
)  # fmt: skip


class NoInstantError(RunFailed):
    """A run has no instant at the time that is asked for."""


def write_surface(results: Results, path: Path, time: float | None = None) -> float:
    """Write the diaphragm at the written instant nearest to a time; returns that instant [s].

    Parameters
    ----------
    results
        A run's results.
    path
        File to write, ``.ply`` or ``.stl`` (``FORMATS``). Metres in the tank's frame, triangles
        counter-clockwise seen from the gas. A PLY also has the nodes' pressures [Pa], slips [m]
        and their works [J/m^2], in double precision; an STL has neither these nor shared nodes,
        and single precision: 1e-7 of the size.
    time
        The time [s]; None for the last instant.

    Raises
    ------
    NoInstantError
        No instant was written, or the time is outside of the run.
    RunFailed
        The file cannot be written.
    """
    row = instant_row(results, time)
    values = {} if path.suffix == ".stl" else {n: getattr(results, n)[row] for n in _SCALARS}
    mesh = meshio.Mesh(
        results.position[row],
        [("triangle", results.triangles.astype(np.int32))],
        point_data={name: value for name, value in values.items() if not np.isnan(value).any()},
    )
    with replacing(path) as part:
        mesh.write(part, file_format=FORMATS[path.suffix], binary=True)
    return float(results.time[row])


def instant_row(results: Results, time: float | None, *, first: bool = False) -> int:
    """Return the row of the written instant nearest to a time [s].

    Without a time that of the last instant, or of the ``first``. Raises ``NoInstantError`` where no
    instant was written or the time is outside of the run.
    """
    instants = results.time
    if not len(instants):
        raise NoInstantError("no instant was written yet. Wait for the run's first step.")
    if time is None:
        return 0 if first else len(instants) - 1
    if not instants[0] <= time <= instants[-1]:
        raise NoInstantError(
            f"has instants from {instants[0]:g} to {instants[-1]:g} s, got {time:g}. "
            "Give a time between."
        )
    return int(np.argmin(np.abs(instants - time)))
