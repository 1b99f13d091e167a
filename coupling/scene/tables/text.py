"""Text of a table's file: decoded, split into lines, and how a line is split into cells."""

from __future__ import annotations

import csv
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

_NUMBER = re.compile(r"[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?", re.IGNORECASE)
_DATE = re.compile(r"\d{4}-\d\d-\d\d.*|\d{1,2}:\d\d:\d\d.*")
_NOTHING = {"", "nan", "na", "n/a", "null", "-", "inf", "-inf"}
_LONGEST = 10_000  # characters of a line
_SAMPLE = 100  # lines looked at, of the beginning, the middle and the end each
COMMENT = ("#", "%", "//")


class TableError(ValueError):
    """A table that cannot be used; the message names the file, the line and the mend."""


def read_content(path: Path) -> bytes:
    """Content of a file. Raises ``TableError`` where it cannot be read."""
    try:
        return path.read_bytes()
    except OSError as error:
        mend = "Give a file that is there and may be read."
        raise TableError(f"{path}: cannot be read: {error.strerror}. {mend}") from error


def lines_of(path: Path, data: bytes) -> list[str]:
    """Lines of a text in UTF-8, UTF-16 or Latin-1, without a byte order mark.

    Raises ``TableError``, with the ``path`` it comes from, for what is no text.
    """
    try:
        text = _decoded(data)
    except UnicodeDecodeError as error:
        raise TableError(f"{path}: is not a text file. Export it as CSV, in UTF-8.") from error
    if "\0" in text:
        raise TableError(f"{path}: is not a text file. Export it as CSV, in UTF-8.")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").split("\n")
    longest = max(map(len, lines))
    if longest > _LONGEST:
        number = 1 + next(k for k, line in enumerate(lines) if len(line) == longest)
        raise TableError(
            f"{path}: line {number}: holds {longest} characters, at most {_LONGEST} are read. "
            "Export a table with one sample a line."
        )
    return lines


def _decoded(data: bytes) -> str:
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        return data.decode("utf-16")
    start = data[:1000]
    for encoding, first in (("utf-16-le", 1), ("utf-16-be", 0)):  # every second byte is 0
        if b"\0" in start and not any(start[first::2]):
            return data.decode(encoding)
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


@dataclass(frozen=True, kw_only=True)
class Dialect:
    """How lines are written: ``separator`` (None: blanks), ``decimal`` mark, ``cells`` a line."""

    separator: str | None
    decimal: str
    cells: int

    def split(self, line: str) -> list[str]:
        """Cells of a line, without the blanks and quotes around them."""
        if self.separator is None:
            return [cell.strip("\"'") for cell in line.split()]
        row = next(csv.reader([line], delimiter=self.separator, skipinitialspace=True), [])
        return [cell.strip().strip("'") for cell in row]

    def numbers(self, line: str) -> bool:
        """Whether this may be a line of numbers: more than half of its cells are."""
        row = self.split(line)
        return len(row) >= 2 and 2 * sum(map(is_number, row)) > len(row) and _any_number(row)

    def is_date(self, line: str, place: int) -> bool:
        """Whether a cell of a line is a date or a time of the day."""
        row = self.split(line)
        return place < len(row) and bool(_DATE.fullmatch(row[place]))


def is_number(cell: str) -> bool:
    """Whether ``cell`` is a number, a time, or what stands for a value that is missing."""
    return cell.lower() in _NOTHING or bool(_NUMBER.fullmatch(cell) or _DATE.fullmatch(cell))


def _any_number(row: Sequence[str]) -> bool:
    return any(_NUMBER.fullmatch(cell) for cell in row)


def dialect_of(lines: Sequence[str]) -> Dialect | None:
    """The separator in which most lines are numbers, and the decimal mark in them.

    Of separators that are equally good the first of semicolon, tab, comma and blanks is taken.
    None where no line holds two numbers.
    """
    sample = [line for line in _sampled(lines) if not line.lstrip().startswith(COMMENT)]
    best, found = 0, None
    for separator in (";", "\t", ",", None):
        any_width = Dialect(separator=separator, decimal=".", cells=0)
        rows = [any_width.split(line) for line in sample if any_width.numbers(line)]
        if not rows:
            continue
        width, _ = Counter(map(len, rows)).most_common(1)[0]
        count = sum(len(row) == width for row in rows)
        if count > best:
            decimal = "." if separator == "," and not _quoted(rows) else _decimal(rows, lines)
            best, found = count, Dialect(separator=separator, decimal=decimal, cells=width)
    return found


def _sampled(lines: Sequence[str]) -> list[str]:
    middle = max(len(lines) // 2, _SAMPLE)
    end = max(len(lines) - _SAMPLE, middle + _SAMPLE)
    parts = lines[:_SAMPLE], lines[middle : middle + _SAMPLE], lines[end:]
    return [line for part in parts for line in part if line.strip()]


def _quoted(rows: Sequence[Sequence[str]]) -> bool:
    """Whether cells that were separated by commas hold commas: they stood in quotes."""
    return any("," in cell for row in rows for cell in row)


def _decimal(rows: Sequence[Sequence[str]], lines: Sequence[str]) -> str:
    numbers = "".join(cell for row in rows for cell in row if _NUMBER.fullmatch(cell))
    if "," in numbers or "." in numbers:
        return "," if "," in numbers else "."
    return "," if any("," in line for line in lines) else "."
