"""A file of forces on a free tank: a table of time, fx, fy, fz, and of moments if it turns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from coupling.scene.motion_file import COLUMNS as MOTION_COLUMNS
from coupling.scene.motion_file import increasing
from coupling.scene.motion_table import MotionTable
from coupling.scene.tables.columns import FORCE, MOMENT, Column
from coupling.scene.tables.file import table_of
from coupling.scene.tables.text import TableError, read_content

_FORCES = (
    MOTION_COLUMNS[0],
    *(
        Column(name=f"f{axis}", pattern=rf"(f|force|kraft){axis}", unit="N", units=FORCE)
        for axis in "xyz"
    ),
)
_MOMENTS = tuple(
    Column(
        name=f"m{axis}", pattern=rf"(m|moment|torque|drehmoment){axis}", unit="N m", units=MOMENT
    )
    for axis in "xyz"
)


@dataclass(frozen=True, kw_only=True, eq=False)
class ForceTable:
    """``forces`` [N] in place of accelerations, and ``moments`` [N m] likewise, None for none.

    A force is to its impulse what an acceleration is to a velocity, so one table serves both.
    """

    forces: MotionTable
    moments: MotionTable | None


def read_force_table(path: Path) -> ForceTable:
    """Read a table of forces, laid out as ``table_of`` says.

    Raises ``TableError`` as that, for times that do not increase, and for some of three moments.
    """
    return _read(path, read_content(path))


@lru_cache(maxsize=2)  # a study asks for the same table again and again
def _read(path: Path, data: bytes) -> ForceTable:
    table = table_of(path, data, _FORCES)
    time = increasing(table)
    forces = MotionTable(time=time, acceleration=table.values[:, 1:])
    named = [c.name for c in _MOMENTS if any(c.read(head) is not None for head in table.others)]
    if not named:
        return ForceTable(forces=forces, moments=None)
    if len(named) < len(_MOMENTS):
        missing = ", ".join(c.name for c in _MOMENTS if c.name not in named)
        raise TableError(
            f"{path}: line {table.header}: names {', '.join(named)} and no {missing}. Give all "
            "three moments, with zeros about an axis that has none."
        )
    whole = table_of(path, data, (*_FORCES, *_MOMENTS))
    moments = MotionTable(time=time, acceleration=whole.values[:, 4:])
    return ForceTable(forces=forces, moments=moments)
