"""Tables of numbers in CSV files: read line by line, so that an error can name its line."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.ports import Array

LEAST_LINES = 2
_COUNTS = {3: "three", 4: "four"}


class TableError(ValueError):
    """A table that cannot be used; the message names the file, the line and the mend."""


@dataclass(frozen=True, kw_only=True)
class Table:
    """``values`` (k, c), all finite, of ``path``; ``lines`` are the k numbers of their lines."""

    path: Path
    values: Array
    lines: tuple[int, ...]

    def where(self, row: int) -> str:
        """File and line of a row, for messages."""
        return f"{self.path}: line {self.lines[row]}"


def read_table(path: Path, names: Sequence[str], units: str) -> Table:
    """Read a table of the columns ``names``, whose ``units`` are told in messages.

    One header line is allowed, as are empty lines and lines that start with ``#``.

    Raises ``TableError`` for a file that cannot be read, for a line that does not hold a finite
    number for every column and for fewer than two lines of numbers. Whether the header names the
    same columns is not checked.
    """
    rows: list[list[float]] = []
    lines: list[int] = []
    may_be_header = True
    for number, line in enumerate(_text(path).splitlines(), start=1):
        stripped = line.strip()
        if not stripped or stripped.startswith("#"):
            continue
        row = _numbers(stripped)
        if row is None and may_be_header:
            may_be_header = False
            continue
        may_be_header = False
        if row is None or len(row) != len(names) or not np.isfinite(row).all():
            raise TableError(
                f"{path}: line {number}: must hold {_COUNTS[len(names)]} finite numbers "
                f"{', '.join(names)} separated by commas, got '{stripped[:80]}'."
            )
        rows.append(row)
        lines.append(number)
    if len(rows) < LEAST_LINES:
        raise TableError(
            f"{path}: holds {len(rows)} lines of numbers, at least {LEAST_LINES} are needed. "
            f"Give columns {', '.join(names)} ({units})."
        )
    return Table(path=path, values=np.array(rows), lines=tuple(lines))


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except OSError as error:
        raise TableError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise TableError(f"{path}: is not a text file. Give a CSV file.") from error


def _numbers(text: str) -> list[float] | None:
    """Numbers of a line, None where a cell is not one."""
    try:
        return [float(cell) for cell in text.split(",")]
    except ValueError:
        return None
