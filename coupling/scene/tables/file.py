"""Tables of numbers in text files, as loggers and spreadsheets write them.

The cells are converted by pandas, imported only where there is a table to read.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from coupling.ports import Array, Ints
from coupling.scene.tables.clock import seconds_of_dates, seconds_of_numbers
from coupling.scene.tables.columns import Column
from coupling.scene.tables.head import Head, read_head
from coupling.scene.tables.text import COMMENT, Dialect, TableError, dialect_of, lines_of

if TYPE_CHECKING:
    from pandas import Series

LEAST_LINES = 2
_COUNTS = {2: "two", 3: "three", 4: "four"}
_SEPARATORS = {",": "commas", ";": "semicolons", "\t": "tabs", None: "blanks"}
_REMOVE = "Correct the line, or remove it: between its neighbours values are linear."
_HEADER = (
    "Name the columns in a line above the numbers; write decimals with a point where commas "
    "separate the columns."
)
_NAME_ALL = "Name every column; write decimals with a point where commas separate the columns."
_DATES = "Give time in seconds, or as ISO 8601 has it, such as 2026-01-31T10:00:00.005."


@dataclass(frozen=True, kw_only=True, eq=False)
class Table:
    """``values`` (k, c) of the columns wanted, all finite, and where they come from.

    ``lines`` (k,): numbers of the lines; ``header``: number of the line with the names, 0 for none;
    ``units``: those that the file gives, by column, "" for none; ``others``: names of the further
    columns; ``start``: of times that were dates or seconds since 1970, the first one.
    """

    path: Path
    values: Array
    lines: Ints
    header: int
    units: tuple[str, ...]
    others: tuple[str, ...]
    start: str | None

    def where(self, row: int) -> str:
        """File and line of a row, for messages."""
        return f"{self.path}: line {self.lines[row]}"


def table_of(path: Path, data: bytes, wanted: Sequence[Column]) -> Table:
    """Read the columns ``wanted``, each in its own unit, whatever their order in the file.

    Separated by commas, semicolons, tabs or blanks, with a decimal point or comma, in UTF-8,
    UTF-16 or Latin-1. Above the numbers may stand a header that names columns and units, a row of
    units, and other text; columns that are not wanted are left out. Without a header the lines
    hold the columns wanted, in their order and units. Empty lines and lines that start with
    ``#``, ``%`` or ``//`` are left out among the numbers.

    ``data``: the content of the file ``path``, which messages name. Raises ``TableError`` for what
    is no text, for a header that does not name every column once, in a known unit, for a line that
    does not hold a finite number for every column and for fewer than two lines of numbers.
    """
    lines = lines_of(path, data)
    dialect = dialect_of(lines)
    first = len(lines) if dialect is None else _first(lines, dialect)
    rows = [
        k
        for k in range(first, len(lines))
        if (line := lines[k]) and (line[0] not in _MAY_BE_LEFT_OUT or not _left_out(line))
    ]
    if dialect is None or len(rows) < LEAST_LINES:
        names = ", ".join(column.name for column in wanted)
        units = ", ".join(column.unit for column in wanted)
        raise TableError(
            f"{path}: holds {len(rows)} lines of numbers, at least {LEAST_LINES} are needed. "
            f"Give columns {names} ({units})."
        )
    head = read_head(path, lines[:first], dialect, wanted)
    body = _Body(path, [lines[k] for k in rows], np.array(rows) + 1, dialect, wanted)
    if head is None:
        count = len(wanted)
        head = Head(line=0, cells=count, places=tuple(range(count)), units=("",) * count)
    body.check_cells(head)
    values, start = body.values(head)
    return Table(
        path=path, values=values, lines=body.numbers, header=head.line, units=head.units,
        others=head.others, start=start,
    )  # fmt: skip


_MAY_BE_LEFT_OUT = " \t#%/"  # first characters


def _left_out(line: str) -> bool:
    text = line.lstrip()
    return not text or text.startswith(COMMENT)


def _first(lines: Sequence[str], dialect: Dialect) -> int:
    """Index of the first line of numbers."""
    return next(k for k, line in enumerate(lines) if not _left_out(line) and dialect.numbers(line))


class _Body:
    """The ``lines`` of numbers that hold the columns ``wanted``; ``numbers`` theirs in the file."""

    def __init__(
        self,
        path: Path,
        lines: Sequence[str],
        numbers: Ints,
        dialect: Dialect,
        wanted: Sequence[Column],
    ) -> None:
        self.path, self.lines, self.numbers = path, lines, numbers
        self.dialect, self.wanted = dialect, wanted
        self.text = "\n".join(lines)

    def check_cells(self, head: Head) -> None:
        """Every line must hold as many cells as there are columns, but for empty ones at its end.

        A cell that is left out would move those behind it into other columns.
        """
        cells, wanted, separator = self._count(), head.cells, self.dialect.separator or " "
        for row in np.flatnonzero(cells != wanted).tolist():
            few = bool(cells[row] < wanted)
            one_more = cells[row] == wanted + 1 and self.lines[row].endswith(separator)
            if one_more or not (few or any(self.dialect.split(self.lines[row])[wanted:])):
                continue
            if head.line == 0:
                raise self._wrong(row, 1, _REMOVE if few else _HEADER)
            mend = "Complete the line, or remove it." if few else _NAME_ALL
            raise TableError(
                f"{self.path}: line {self.numbers[row]}: holds {cells[row]} columns, line "
                f"{head.line} names {wanted}, got '{self._shown(row)}'. {mend}"
            )

    def _count(self) -> Ints:
        """Cells (k,) of the lines."""
        separator = self.dialect.separator
        if separator is None or '"' in self.text:
            for row, line in enumerate(self.lines):
                if line.count('"') % 2:
                    raise TableError(
                        f"{self.path}: line {self.numbers[row]}: a quote is not closed, got "
                        f"'{self._shown(row)}'. Close it, or leave quotes out."
                    )
            return np.array([len(self.dialect.split(line)) for line in self.lines])
        letters = np.frombuffer(self.text.encode(), dtype=np.uint8)
        ends = np.append(np.flatnonzero(letters == ord("\n")), len(letters))
        marks = np.flatnonzero(letters == ord(separator))
        return np.asarray(1 + np.diff(np.searchsorted(marks, ends), prepend=0), dtype=np.int64)

    def values(self, head: Head) -> tuple[Array, str | None]:
        """Values (k, c), and the first of times that were dates."""
        import pandas as pd

        frame = pd.read_csv(
            StringIO(self.text),
            sep=self.dialect.separator or r"\s+",
            header=None,
            names=list(range(max(self.dialect.cells, head.cells))),
            usecols=list(head.places),
            index_col=False,
            decimal=self.dialect.decimal,
            skip_blank_lines=False,
            skipinitialspace=True,
            low_memory=False,
        )
        start = None
        columns = []
        for column, place, unit in zip(self.wanted, head.places, head.units, strict=True):
            cells = frame[place]
            if cells.dtype.kind in "iuf":
                numbers = cells.to_numpy()
            elif column.clock and self.dialect.is_date(self.lines[0], place):
                numbers, unit = seconds_of_dates(cells.astype(str)), ""
                start = str(cells.iloc[0])
            else:
                row, count = self._no_numbers(cells)
                dates = column.clock and count == len(self.lines)
                raise self._wrong(row, count, _DATES if dates else _REMOVE)
            columns.append((column, numbers, unit))
        finite = np.all([np.isfinite(numbers) for _, numbers, _ in columns], axis=0)
        if not finite.all():
            raise self._wrong(int(np.argmin(finite)), int((~finite).sum()), _REMOVE)
        values = []
        for column, numbers, unit in columns:
            factor = column.factor(unit)
            assert factor is not None
            if column.clock and start is None:
                where = f"{self.path}: line {self.numbers[0]}"
                numbers, start = seconds_of_numbers(numbers, unit, factor, where)
                factor = 1.0
            values.append(factor * numbers)
        return np.column_stack(values).astype(np.float64), start

    def _no_numbers(self, cells: Series[str]) -> tuple[int, int]:
        """The first of the cells that are no numbers, and how many they are."""
        import pandas as pd

        text = cells.astype(str).str.strip()
        if self.dialect.decimal == ",":
            text = text.where(~text.str.contains(".", regex=False), "")
            text = text.str.replace(",", ".", regex=False)
        wrong = np.asarray(~np.isfinite(pd.to_numeric(text, errors="coerce").astype(float)))
        return int(np.argmax(wrong)), max(int(wrong.sum()), 1)

    def _shown(self, row: int) -> str:
        return self.lines[row].strip()[:80]

    def _wrong(self, row: int, count: int, mend: str) -> TableError:
        names = ", ".join(column.name for column in self.wanted)
        more = f" (and {count - 1} more lines)" if count > 1 else ""
        return TableError(
            f"{self.path}: line {self.numbers[row]}: must hold {_COUNTS[len(self.wanted)]} finite "
            f"numbers {names} separated by {_SEPARATORS[self.dialect.separator]}, got "
            f"'{self._shown(row)}'{more}. {mend}"
        )
