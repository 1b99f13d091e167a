"""Measured tank accelerations: a CSV file with the columns time, ax, ay, az in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.ports import Array
from coupling.table_file import TableError, read_table


@dataclass(frozen=True, kw_only=True)
class MotionTable:
    """``time`` (k,) [s], strictly increasing; ``acceleration`` (k, 3) [m/s^2] of the tank."""

    time: Array
    acceleration: Array


def read_motion_table(path: Path) -> MotionTable:
    """Read a table of accelerations, laid out as ``read_table`` says.

    Raises ``TableError`` for a file that is no table of four columns, and for times that do not
    increase. Whether the samples resolve the motion is not checked.
    """
    table = read_table(path, ("time", "ax", "ay", "az"), "s, m/s^2")
    time = table.values[:, 0]
    unordered = np.flatnonzero(np.diff(time) <= 0.0)
    if len(unordered) > 0:
        row = int(unordered[0]) + 1
        raise TableError(
            f"{table.where(row)}: time must increase, got {time[row]:g} after {time[row - 1]:g}. "
            "Sort the lines and remove repeated times."
        )
    return MotionTable(time=time, acceleration=table.values[:, 1:])
