"""Measured tank accelerations: a CSV file with the columns time, ax, ay, az in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.ports import Array


class MotionTableError(ValueError):
    """A table that cannot be used; the message names the file, the line and the mend."""


@dataclass(frozen=True, kw_only=True)
class MotionTable:
    """``time`` (k,) [s], strictly increasing; ``acceleration`` (k, 3) [m/s^2] of the tank."""

    time: Array
    acceleration: Array


def _numbers(text: str) -> list[float] | None:
    """Numbers of a line, None where a cell is not one."""
    try:
        return [float(cell) for cell in text.split(",")]
    except ValueError:
        return None


def read_motion_table(path: Path) -> MotionTable:
    """Read a table of accelerations.

    One header line is allowed, as are empty lines and lines that start with ``#``.

    Raises ``MotionTableError`` for a file that cannot be read, for a line that does not hold four
    finite numbers, for times that do not increase and for fewer than two lines of numbers.
    Whether the samples resolve the motion is not checked.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise MotionTableError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise MotionTableError(f"{path}: is not a text file. Give a CSV file.") from error
    rows: list[list[float]] = []
    may_be_header = True
    for number, line in enumerate(text.splitlines(), start=1):
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        row = _numbers(stripped)
        if row is None and may_be_header:
            may_be_header = False
            continue
        may_be_header = False
        _check_row(f"{path}: line {number}", stripped, row, rows)
        assert row is not None
        rows.append(row)
    if len(rows) < 2:
        raise MotionTableError(
            f"{path}: holds {len(rows)} lines of numbers, at least 2 are needed. "
            "Give columns time, ax, ay, az (s, m/s^2)."
        )
    values = np.array(rows)
    return MotionTable(time=values[:, 0], acceleration=values[:, 1:])


def _check_row(where: str, text: str, row: list[float] | None, before: list[list[float]]) -> None:
    if row is None or len(row) != 4 or not np.isfinite(row).all():
        raise MotionTableError(
            f"{where}: must hold four finite numbers time, ax, ay, az separated by commas, "
            f"got '{text[:80]}'."
        )
    if before and row[0] <= before[-1][0]:
        raise MotionTableError(
            f"{where}: time must increase, got {row[0]:g} after {before[-1][0]:g}. "
            "Sort the lines and remove repeated times."
        )
