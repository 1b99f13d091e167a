"""Thickness of the moulded diaphragm from place to place: a CSV file beside the scene."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.ports import Array, Ints
from coupling.scene.tables.columns import ANGLE, LENGTH, Column
from coupling.scene.tables.file import Table, table_of
from coupling.scene.tables.text import TableError, read_content

RIM = 90.0  # degrees from the pole
_SLACK = 1e-9  # degrees, of angles that were computed
_COLUMNS = (
    Column(name="polar", pattern=r"polar(angle)?|theta", unit="degrees", units=ANGLE),
    Column(name="azimuth", pattern=r"azimuth(al)?(angle)?|phi", unit="degrees", units=ANGLE),
    Column(name="thickness", pattern=r"t|thickness", unit="m", units=LENGTH),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class ThicknessMap:
    """Bilinear between a grid of angles on the moulded shape, closed round the pole's axis.

    On the unit hemisphere of the mould's chart: the polar angle is 90 degrees times the arc length
    from the pole over the meridian's; of a hemisphere that is its own angle.

    ``polar`` (p,) [rad], increasing from 0 at the pole to pi/2 at the rim; ``azimuth`` (a,) [rad],
    increasing in [0, 2 pi), from x to y, a single one for a map that is the same all round;
    ``thickness`` (p, a) [m].
    """

    polar: Array
    azimuth: Array
    thickness: Array

    def at(self, points: Array) -> Array:
        """Thickness (k,) [m] in the direction of ``points`` (k, 3) from the centre, z to the pole.

        Directions below the rim are taken at the rim.
        """
        x, y, z = points.T
        polar = np.clip(np.arctan2(np.hypot(x, y), z), self.polar[0], self.polar[-1])
        if len(self.azimuth) == 1:
            return np.asarray(np.interp(polar, self.polar, self.thickness[:, 0]))
        from scipy.interpolate import RegularGridInterpolator  # takes long, few scenes need it

        first = self.azimuth[0]
        azimuth = first + np.mod(np.arctan2(y, x) - first, 2.0 * np.pi)
        closed = np.append(self.azimuth, first + 2.0 * np.pi)
        around = np.column_stack([self.thickness, self.thickness[:, 0]])
        between = RegularGridInterpolator((self.polar, closed), around)
        return np.asarray(between(np.column_stack([polar, np.minimum(azimuth, closed[-1])])))

    @property
    def mean(self) -> float:
        """Of a hemisphere's area [m]: exact for the bilinear map."""
        a, b = self.polar[:-1], self.polar[1:]
        # Of the integral of sin over [a, b], what belongs to the hat function of b.
        upper = (np.sin(b) - np.sin(a)) / (b - a) - np.cos(b)
        lower = np.cos(a) - np.cos(b) - upper
        along = np.append(lower, 0.0) + np.append(0.0, upper)
        gaps = np.diff(np.append(self.azimuth, self.azimuth[0] + 2.0 * np.pi))
        around = 0.5 * (gaps + np.roll(gaps, 1)) / (2.0 * np.pi)
        return float(along @ self.thickness @ around)


def read_thickness_map(path: Path) -> ThicknessMap:
    """Read a map with the columns polar, azimuth [degrees], thickness [m], in any order of lines.

    Laid out as ``table_of`` says; a header may name other units. Raises ``TableError`` as that,
    for a line out of range, and unless every polar angle, 0 and 90 among them, stands once with
    every azimuth.
    """
    table = table_of(path, read_content(path), _COLUMNS)
    _check_lines(table)
    polar, row = np.unique(table.values[:, 0], return_inverse=True)
    azimuth, column = np.unique(table.values[:, 1], return_inverse=True)
    if polar[0] > _SLACK or polar[-1] < RIM - _SLACK:
        raise TableError(
            f"{path}: polar must cover 0 to 90 degrees, covers {polar[0]:g} to {polar[-1]:g}. "
            "Give the angle from the pole: 0 there, 90 at the rim."
        )
    line = _places(table, polar, azimuth, row, column)
    thickness = table.values[line, 2]
    uneven = np.flatnonzero(thickness[0] != thickness[0, 0])
    if len(uneven) > 0:
        raise TableError(
            f"{table.where(line[0, uneven[0]])}: the pole is one point, its thickness must be the "
            f"same for every azimuth, got {thickness[0, uneven[0]]:g} after {thickness[0, 0]:g}. "
            "Give one thickness at polar 0."
        )
    polar[[0, -1]] = 0.0, RIM
    return ThicknessMap(polar=np.deg2rad(polar), azimuth=np.deg2rad(azimuth), thickness=thickness)


def _check_lines(table: Table) -> None:
    polar, azimuth, thickness = table.values.T
    wrong = (
        ((polar < -_SLACK) | (polar > RIM + _SLACK), polar, "polar must lie in [0, 90]",
         "Give degrees from the pole: 0 there, 90 at the rim."),
        ((azimuth < 0.0) | (azimuth >= 360.0), azimuth, "azimuth must lie in [0, 360)",
         "Leave 360 out: the map closes by itself; add 360 to a negative angle."),
        (thickness <= 0.0, thickness, "thickness must be positive",
         "Give the moulded thickness in metres."),
    )  # fmt: skip
    for bad, values, what, mend in wrong:
        if bad.any():
            row = int(np.flatnonzero(bad)[0])
            raise TableError(f"{table.where(row)}: {what}, got {values[row]:g}. {mend}")


def _places(table: Table, polar: Array, azimuth: Array, row: Ints, column: Ints) -> Ints:
    """Where in ``table`` each place (p, a) of the grid stands; every one once."""
    places = np.full((len(polar), len(azimuth)), -1, dtype=np.int64)
    for line, place in enumerate(zip(row, column, strict=True)):
        if places[place] >= 0:
            raise TableError(
                f"{table.where(line)}: polar {polar[place[0]]:g}, azimuth {azimuth[place[1]]:g} "
                f"is given again, first in line {table.lines[places[place]]}. "
                "Remove one of the two."
            )
        places[place] = line
    missing = np.argwhere(places < 0)
    if len(missing) > 0:
        p, a = missing[0]
        raise TableError(
            f"{table.path}: polar {polar[p]:g}, azimuth {azimuth[a]:g} is missing, and "
            f"{len(missing) - 1} more. Give every polar angle with every azimuth, "
            f"{len(polar)} x {len(azimuth)} lines; or a single azimuth for a map that is the same "
            "all round."
        )
    return places
