"""A scan of a real diaphragm, held against a run's."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.ports import Array
from coupling.scans.errors import ScanError
from coupling.scans.reading import UNITS
from coupling.store.atomic import write_json, write_text
from coupling.store.folder_lock import FolderError
from coupling.store.results import open_results
from coupling.store.surface import NoInstantError


@dataclass(frozen=True, kw_only=True)
class ScanComparison:
    """A scan held against a run.

    Attributes
    ----------
    folder : Path
        Where ``compare.json``, ``compare.csv`` and ``compare.html`` are.
    table : Mapping
        What ``compare.json`` holds: figures with their errors, as given and aligned, the motion
        that aligns, the share that it explains, remarks.
    """

    folder: Path
    table: Mapping[str, Any]


def compare_scan(
    scan: str | Path,
    run: str | Path,
    unit: str,
    *,
    at: float | None = None,
    out: str | Path | None = None,
) -> ScanComparison:
    """Hold a scan of a diaphragm against a run's, as it is given and aligned; write what was found.

    Parameters
    ----------
    scan : str or Path
        PLY, STL or OBJ, a point cloud or a surface, noisy, holed or of a part, in the tank's frame
        but for a small motion and any rotation about its axis.
    run : str or Path
        Folder of a run.
    unit : str
        Unit of the scan's coordinates: ``mm``, ``m`` or ``in``.
    at : float, optional
        The written instant of the run nearest to this [s]; if left out the first one, at which it
        has settled.
    out : str or Path, optional
        Folder to write to; the run's own if left out.

    Returns
    -------
    ScanComparison

    Raises
    ------
    ScanError
        The scan cannot be used: unreadable, too few points, not on the diaphragm, another unit;
        or the unit or the time are wrong.
    UnreadableFile
        The run has no results.
    FolderError, RunFailed
        The folder cannot be written.
    """
    from coupling.report.write import write_scan_report
    from coupling.scans.comparison import compare_points

    if unit not in UNITS:
        raise ScanError(f"unit: must be {', '.join(UNITS)}, got '{unit}'.")
    results, folder = open_results(run), Path(run if out is None else out)
    try:
        found = compare_points(Path(scan), unit, results, at)
    except NoInstantError as error:
        raise ScanError(f"at: {run} {error}") from error
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FolderError(
            f"{folder}: cannot be written: {error.strerror}. Give another folder with -o."
        ) from error
    table = {"run": str(run), **found.table}
    write_json(folder / "compare.json", table)
    write_text(folder / "compare.csv", _csv(found.nodes))
    write_scan_report(folder, table, found.nodes, results.triangles)
    return ScanComparison(folder=folder, table=table)


def _csv(nodes: Mapping[str, Array]) -> str:
    """One row a node; empty where there is no value."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["node", *nodes])
    for number, row in enumerate(np.column_stack(list(nodes.values()))):
        writer.writerow([number, *("" if np.isnan(one) else f"{one:.9g}" for one in row)])
    return text.getvalue()
