"""Scans of a diaphragm as points in metres: PLY, STL and OBJ, with faces or without."""

from __future__ import annotations

import warnings
from pathlib import Path

import meshio
import numpy as np

from coupling.ports import Array
from coupling.scans.errors import ScanError

UNITS = {"mm": 1e-3, "m": 1.0, "in": 0.0254}
LEAST = 100  # points: as many as blocks of the sampling error need
_HEADER = 100_000  # bytes that a PLY's header may have
_LARGEST, _SMALLEST = 3.0, 0.05  # of a scan's size over the diaphragm's


def read_scan(path: Path, unit: str) -> Array:
    """Return the points (p, 3) [m] of a scan, each of them once.

    Parameters
    ----------
    path
        ``.ply``, ``.stl`` or ``.obj``. Faces are not used: a point cloud will do.
    unit
        Unit of its coordinates, a name in ``UNITS``.

    Raises
    ------
    ScanError
        The file cannot be read, or holds too few points or one that is not finite.
    """
    reader = _READERS.get(path.suffix.lower())
    if reader is None:
        raise ScanError(f"{path}: must end in {', '.join(_READERS)}. Convert the scan.")
    try:
        with warnings.catch_warnings(action="ignore"):  # a text that is no STL overflows its count
            points = np.asarray(reader(path), dtype=float)
    except FileNotFoundError as error:
        raise ScanError(f"{path}: no such file. Give the scan's file.") from error
    except _UNREADABLE as error:
        said = str(error) or type(error).__name__
        raise ScanError(
            f"{path}: cannot be read as {path.suffix[1:].upper()}: {said}. Export the scan again."
        ) from error
    points = points.reshape(-1, 3)
    if not np.isfinite(points).all():
        bad = int((~np.isfinite(points)).any(axis=1).sum())
        raise ScanError(f"{path}: points that are not finite: {bad}. Remove them from the scan.")
    points = np.unique(points, axis=0)  # an STL has every point once for each of its triangles
    if len(points) < LEAST:
        raise ScanError(
            f"{path}: has {len(points)} different points, and {LEAST} are needed to state the "
            "errors. Give a scan with more."
        )
    return UNITS[unit] * points


def check_size(points: Array, position: Array, path: Path, unit: str) -> None:
    """Raise ``ScanError`` where a scan is so much larger or smaller that its unit must be wrong.

    ``points`` (p, 3) of the scan and ``position`` (n, 3) of the diaphragm [m]. A scan may be a part
    of the diaphragm, but hardly a twentieth of its size, nor three times as large.
    """
    size, wanted = (float(np.linalg.norm(np.ptp(one, axis=0))) for one in (points, position))
    ratio = size / wanted
    if _SMALLEST <= ratio <= _LARGEST:
        return
    better = min(UNITS, key=lambda name: abs(np.log(ratio * UNITS[name] / UNITS[unit])))
    mend = f"Is --unit {better} meant?" if better != unit else "Look at the scan's unit."
    raise ScanError(
        f"{path}: taken as {unit} it is {size:.3g} m across, and the run's diaphragm "
        f"{wanted:.3g} m. {mend}"
    )


def _obj_points(path: Path) -> list[list[float]]:
    """Points of an OBJ: its lines ``v``, also of textured ones, which meshio does not read."""
    with path.open(encoding="utf-8", errors="replace") as file:
        points = [line.split()[1:4] for line in file if line[:2] == "v "]
    for number, point in enumerate(points, 1):
        if len(point) < 3:
            raise ValueError(f"point {number} has {len(point)} coordinates")
    return [[float(word) for word in point] for point in points]


def _ply_points(path: Path) -> Array:
    """Points of a PLY whose header ends; in one that does not meshio reads on for ever."""
    with path.open("rb") as file:
        if b"end_header" not in file.read(_HEADER):
            raise meshio.ReadError("Expected ply with an end_header")
    return np.asarray(meshio.ply.read(path).points)


# meshio's own ``read`` ends the program where a file is of another format; these raise
_READERS = {
    ".ply": _ply_points,
    ".stl": lambda path: meshio.stl.read(path).points,
    ".obj": _obj_points,
}
_UNREADABLE = (
    meshio.ReadError, OSError, ValueError, KeyError, IndexError, TypeError, AssertionError,
    StopIteration, UnicodeError, EOFError, SyntaxError, RuntimeError,
)  # fmt: skip
