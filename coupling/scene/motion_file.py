"""A file of measured tank accelerations: a table of time, ax, ay and az.

Of a tank that turns it has angular rates or angles as well.
"""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from coupling.ports import Array
from coupling.scene.motion_table import MotionTable
from coupling.scene.tables.columns import ACCELERATION, ANGLE, RATE, TIME, Column
from coupling.scene.tables.file import Table, table_of
from coupling.scene.tables.text import TableError, read_content

_AXIS = (
    r"(linear)?(a|acc|accel|accelerometer|acceleration|beschleunigung|beschl)?"
    r"(axis|achse)?{0}(axis|achse|acc|accel|acceleration)?"
)
COLUMNS = (
    Column(
        name="time",
        pattern=r"t|time|times?stamps?|zeit|datetime|elapsed|elapsedtime|timeelapsed|relativetime"
        r"|utc|utctime|epoch|epochtime|unixtime|isotime|localtime",
        unit="s",
        units=TIME,
        clock=True,
    ),
    *(
        Column(name=f"a{axis}", pattern=_AXIS.format(axis), unit="m/s^2", units=ACCELERATION)
        for axis in "xyz"
    ),
)
_RATE = (
    r"(w|omega|gyro|gyr|gyroscope|angularrate|angularvelocity|angvel|drehrate)(axis|achse)?{0}"
    r"(axis|achse)?"
)
RATES = tuple(
    Column(name=f"w{axis}", pattern=_RATE.format(axis), unit="deg/s", units=RATE) for axis in "xyz"
)
ANGLES = tuple(
    Column(name=name, pattern=pattern, unit="deg", units=ANGLE)
    for name, pattern in (
        ("roll", r"roll(angle|winkel)?|wank(winkel)?"),
        ("pitch", r"pitch(angle|winkel)?|nick(winkel)?"),
        ("yaw", r"yaw(angle|winkel)?|gier(winkel)?"),
    )
)
_MANY = 10  # samples from which on a record's rate says something
_GAP = 2.5  # times the median step: more than one sample is missing
_FEW = 0.05  # share of the steps up to which longer ones are gaps, beyond it the sampling is uneven
_SLOWEST = 0.5  # s between samples, above which a time without a unit may be milliseconds


def read_motion_table(path: Path) -> MotionTable:
    """Read a table of accelerations, laid out as ``table_of`` says.

    Times that are dates, or seconds since 1970, start at 0. Raises ``TableError`` as that, for
    times that do not increase, for times without a unit that are so far apart that they may be
    milliseconds, and for gaps of more than one sample. Whether the samples resolve the motion is
    not checked.
    """
    return _read(path, read_content(path))


@lru_cache(maxsize=2)  # a study asks for the same record again and again
def _read(path: Path, data: bytes) -> MotionTable:
    table, turning = _with_rotation(path, data, table_of(path, data, COLUMNS))
    time = increasing(table)
    apart = float(np.median(np.diff(time)))
    if len(time) >= _MANY and apart >= _SLOWEST and not table.units[0] and table.start is None:
        raise TableError(
            f"{table.where(1)}: time steps by {apart:.4g}, and the file gives no unit of time. "
            "Name it in a header, such as time (ms), ax (m/s^2), ay (m/s^2), az (m/s^2)."
        )
    _check_gaps(table)
    rotation = np.radians(table.values[:, 4:])
    return MotionTable(
        time=time,
        acceleration=table.values[:, 1:4],
        read=_taken_for(table, turning),
        units_given=all(table.units[1:4]),
        rates=rotation if turning is RATES else None,
        angles=rotation if turning is ANGLES else None,
    )


def increasing(table: Table) -> Array:
    """Return a ``table``'s times (k,) [s]; raises ``TableError`` where they do not rise."""
    time = table.values[:, 0]
    unordered = np.flatnonzero(np.diff(time) <= 0.0)
    if len(unordered) > 0:
        row = int(unordered[0]) + 1
        more = f" (and {len(unordered) - 1} more lines)" if len(unordered) > 1 else ""
        raise TableError(
            f"{table.where(row)}: time must increase, got {time[row]:.10g} after "
            f"{time[row - 1]:.10g}{more}. Sort the lines and remove repeated times."
        )
    return time


def _with_rotation(path: Path, data: bytes, table: Table) -> tuple[Table, tuple[Column, ...]]:
    """The ``table`` with the columns of rotation that its header names, and which these are.

    Raises ``TableError`` where it names some of three only, rates and angles, or no unit.
    """
    rates, angles = (
        [c.name for c in group if any(c.read(name) is not None for name in table.others)]
        for group in (RATES, ANGLES)
    )
    if not (rates or angles):
        return table, ()
    where = f"{path}: line {table.header}"
    if rates and angles:
        raise TableError(
            f"{where}: names angular rates and angles, {rates[0]} and {angles[0]} among them. "
            "Leave one of the two out: either says how the tank turns."
        )
    group = RATES if rates else ANGLES
    names = ", ".join(column.name for column in group)
    missing = [column.name for column in group if column.name not in (*rates, *angles)]
    if missing:
        raise TableError(
            f"{where}: names no column {', '.join(missing)} of a tank that turns. Give {names}, "
            "with zeros about an axis that it does not turn about, or rename what is none of them."
        )
    whole = table_of(path, data, (*COLUMNS, *group))
    bare = [c.name for c, unit in zip(group, whole.units[4:], strict=True) if not unit]
    if bare:
        raise TableError(
            f"{where}: gives no unit of {', '.join(bare)}. Write it there, such as {bare[0]} "
            f"({group[0].unit}); nothing is assumed of rotation."
        )
    return whole, group


def _check_gaps(table: Table) -> None:
    """Refuse what a logger has left out; equal values at both ends are a tank that coasts."""
    steps = np.diff(table.values[:, 0])
    changed = np.any(table.values[1:, 1:] != table.values[:-1, 1:], axis=1)
    rows = np.flatnonzero((steps > _GAP * np.median(steps)) & changed)
    if len(steps) < _MANY or not 0 < len(rows) <= _FEW * len(steps):
        return
    row = int(rows[0])
    more = f" (and {len(rows) - 1} more gaps)" if len(rows) > 1 else ""
    raise TableError(
        f"{table.where(row + 1)}: {steps[row]:.3g} s are missing since line {table.lines[row]}, "
        f"where samples are {np.median(steps):.3g} s apart{more}. Fill the gap, with the line "
        "between its ends if that is meant, or give the part before or behind it."
    )


def _taken_for(table: Table, turning: tuple[Column, ...]) -> str:
    """Columns and units, and where they are known from; ``turning``: those of rotation."""
    units = [unit or column.unit for unit, column in zip(table.units[:4], COLUMNS, strict=True)]
    time = f"time [{units[0]}]" if table.start is None else f"time from {table.start} on"
    pairs = zip(COLUMNS[1:], units[1:], strict=True)
    axes = ", ".join(f"{column.name} [{unit}]" for column, unit in pairs)
    if len(set(units[1:])) == 1:
        axes = f"ax, ay, az [{units[1]}]"
    if turning:
        pairs = zip(turning, table.units[4:], strict=True)
        axes += ", " + ", ".join(f"{column.name} [{unit}]" for column, unit in pairs)
        axes += ", all about the tank's own axes"
    known = all(table.units[1:]) and bool(table.units[0] or table.start)
    if table.header == 0:
        source = "columns and units assumed: the file has no header"
    else:
        source = f"by the header in line {table.header}{'' if known else ', missing units assumed'}"
    unused = f", not used: {', '.join(table.others)}" if table.others else ""
    return f"{time}, {axes} ({source}{unused})"
