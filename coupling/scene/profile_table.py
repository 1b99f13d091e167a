"""Points of a tank's meridian: a CSV file beside the scene."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from coupling.ports import Array
from coupling.scene.tables.columns import LENGTH, Column
from coupling.scene.tables.file import table_of
from coupling.scene.tables.text import TableError, read_content

FEWEST = 9  # points; a half circle through so few turns by 22.5 degrees from chord to chord
SHARPEST = 30.0  # degrees between two chords that join in a point of a smooth surface
ON_AXIS = 1e-9  # radius over the largest one, below which a point lies on the axis
_COLUMNS = (
    Column(name="r", pattern=r"r|radius|x", unit="m", units=LENGTH),
    Column(name="z", pattern=r"z|height", unit="m", units=LENGTH),
)


def read_profile(path: Path) -> Array:
    """Read points (n, 2), r and z [m], of a shell's meridian from the lower pole to the upper one.

    Laid out as ``table_of`` says, in the order along the meridian, from either pole. Raises
    ``TableError`` as that, and for what is no smooth meridian whose height rises: too few points, a
    negative radius, an end off the axis, a height that does not rise, an edge.
    """
    table = table_of(path, read_content(path), _COLUMNS)
    lines = np.asarray(table.lines)
    points = table.values
    if points[0, 1] > points[-1, 1]:
        points, lines = points[::-1].copy(), lines[::-1]
    r, z = points.T

    def refuse(row: int, what: str, mend: str) -> TableError:
        return TableError(f"{path}: line {lines[row]}: {what}. {mend}")

    if len(points) < FEWEST:
        raise TableError(
            f"{path}: holds {len(points)} points, at least {FEWEST} are needed. "
            "Give points of the meridian from pole to pole."
        )
    if r.min() < 0.0:
        row = int(np.argmin(r))
        raise refuse(row, f"r must not be negative, got {r[row]:g}", "Give one half of the section")
    for row in (0, -1):
        if r[row] > ON_AXIS * r.max():
            what = f"the first and the last point must lie on the axis, got r = {r[row]:g}"
            raise refuse(row, what, "Give the meridian from pole to pole, each with r = 0")
    inner = np.flatnonzero(r[1:-1] <= ON_AXIS * r.max())
    if len(inner):
        raise refuse(int(inner[0]) + 1, "r = 0 between the poles", "Give one pole at either end")
    falls = np.flatnonzero(np.diff(z) <= 0.0)
    if len(falls):
        row = int(falls[0]) + 1
        what = f"z must rise from point to point, got {z[row]:g} after {z[row - 1]:g}"
        raise refuse(row, what, "A flat or dented end is not computed: give a domed one")
    way = np.diff(points, axis=0)
    angle = np.degrees(np.abs(np.diff(np.unwrap(np.arctan2(way[:, 1], way[:, 0])))))
    if angle.max() > SHARPEST:
        row = int(np.argmax(angle)) + 1
        what = f"the meridian turns by {angle[row - 1]:.0f} degrees, at most {SHARPEST:g} may be"
        raise refuse(row, what, "Give more points where it bends, and an edge's own rounding")
    points[[0, -1], 0] = 0.0
    return points
