"""The text above a table's numbers: which line names the columns, and in which units they are."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from coupling.scene.tables.columns import Column, plain_unit, recognised, without_mark
from coupling.scene.tables.text import COMMENT, Dialect, TableError, is_number


@dataclass(frozen=True, kw_only=True)
class Head:
    """Which cells of a line hold the columns wanted, and what is known of them.

    ``line``: number of the line that names ``cells`` columns, 0 for none; ``places``: of the
    columns wanted among a line's cells; ``units``: "" where the file gives none; ``others``: names
    of the further columns.
    """

    line: int
    cells: int
    places: tuple[int, ...]
    units: tuple[str, ...]
    others: tuple[str, ...] = ()


def read_head(
    path: Path, lines: Sequence[str], dialect: Dialect, wanted: Sequence[Column]
) -> Head | None:
    """What ``lines``, those above the numbers, say of the columns ``wanted``; None if nothing.

    Of several lines that name columns the one counts that names most. Raises ``TableError`` where
    a line of text names other columns or units, or not all of them, or some twice.
    """
    rows = [_head_cells(line, dialect) for line in lines]
    texts = [
        k
        for k, row in enumerate(rows)
        if len(row) > 1 and not any(map(is_number, filter(None, row)))
    ]
    found = {k: recognised(rows[k], wanted) for k in texts}
    if not found or max(found.values()) < 2:
        wide = [k for k in texts if len(rows[k]) == dialect.cells]
        if wide:
            raise _unnamed(path, wide[-1], rows[wide[-1]], wanted)
        _check_text(path, lines, wanted)
        return None
    line = max(found, key=lambda k: (found[k], k))
    below = [k for k in texts if k > line and not lines[k].lstrip().startswith(COMMENT)]
    if len(below) > 1:
        raise TableError(
            f"{path}: line {below[1] + 1}: stands between the names in line {line + 1} and the "
            "numbers. Leave at most one line there, of units."
        )
    names = _Names(path=path, line=line, heads=rows[line])
    units = _Names(path=path, line=below[0], heads=rows[below[0]]) if below else None
    head = _placed(names, units, dialect, wanted)
    bare = [column for column, unit in zip(wanted, head.units, strict=True) if not unit]
    for column, unit in zip(wanted, head.units, strict=True):
        alike = [other for other in bare if other.units is column.units]
        if unit and alike:
            raise TableError(
                f"{names.where}: gives {column.name} in '{unit}' and no unit of "
                f"{', '.join(other.name for other in alike)}. Write it there too."
            )
    for k, text in enumerate(lines[:line]):
        _check_other_unit(path, k, text, bare)
    return head


@dataclass(frozen=True, kw_only=True)
class _Names:
    """Cells of a line of text."""

    path: Path
    line: int
    heads: Sequence[str]

    @property
    def where(self) -> str:
        return f"{self.path}: line {self.line + 1}"


def _head_cells(line: str, dialect: Dialect) -> list[str]:
    """Cells of a line of text; a unit in brackets belongs to the name before it."""
    text = without_mark(line)
    if dialect.separator is None:
        text = re.sub(r"\s+([\[(<{])", r"\1", text)
        text = re.sub(r"[,;]", " ", text)
    return dialect.split(text)


def _placed(
    names: _Names, units: _Names | None, dialect: Dialect, wanted: Sequence[Column]
) -> Head:
    heads = list(names.heads)
    while len(heads) > dialect.cells and not heads[-1]:
        heads.pop()
    if len(heads) > dialect.cells:
        raise TableError(
            f"{names.where}: names {len(heads)} columns, the lines below hold {dialect.cells}. "
            "Name every column; write decimals with a point where commas separate the columns."
        )
    places = [_place(names, column, wanted) for column in wanted]
    return Head(
        line=names.line + 1,
        cells=len(heads),
        places=tuple(places),
        units=tuple(
            _unit(names, units, place, column) for place, column in zip(places, wanted, strict=True)
        ),
        others=tuple(head for k, head in enumerate(heads) if head and k not in places),
    )


def _place(names: _Names, column: Column, wanted: Sequence[Column]) -> int:
    heads = names.heads
    units = {k: unit for k, head in enumerate(heads) if (unit := column.read(head)) is not None}
    known = [k for k, unit in units.items() if column.factor(unit) is not None]
    if len(units) > 1 and len(known) == 1:
        return known[0]  # such as x in g beside x in mm
    if not units:
        raise _unnamed(names.path, names.line, heads, wanted)
    if len(units) > 1:
        both = " and ".join(f"'{heads[k]}'" for k in units)
        raise TableError(
            f"{names.where}: {both} may each be {column.name}. Rename those that are not meant."
        )
    return next(iter(units))


def _unit(names: _Names, units: _Names | None, place: int, column: Column) -> str:
    """Unit of a column from its name or the row of units; "" where neither gives one."""
    unit, where = column.read(names.heads[place]) or "", names.where
    row = units.heads[place] if units is not None and place < len(units.heads) else ""
    if units is not None and plain_unit(row) not in {"", "-"}:
        if unit and column.factor(unit) != column.factor(row):
            raise TableError(
                f"{units.where}: gives {column.name} in '{row}', line {names.line + 1} in "
                f"'{unit}'. Correct the one that is wrong."
            )
        unit, where = row, units.where
    if column.factor(unit) is None:
        raise TableError(
            f"{where}: the unit '{unit}' of {column.name} is not known. Give one of "
            f"{', '.join(column.choices)}."
        )
    return unit.strip("[](){}<> ")


def _unnamed(path: Path, line: int, heads: Sequence[str], wanted: Sequence[Column]) -> TableError:
    missing = [column.name for column in wanted if all(column.read(head) is None for head in heads)]
    return TableError(
        f"{path}: line {line + 1}: names no column {', '.join(missing)}, got "
        f"'{', '.join(heads)[:80]}'. Name the columns {_example(wanted)}, or in other units."
    )


def _example(wanted: Sequence[Column]) -> str:
    return ", ".join(f"{column.name} ({column.unit})" for column in wanted)


def _check_text(path: Path, lines: Sequence[str], wanted: Sequence[Column]) -> None:
    """Above numbers without names may stand comments, but nothing of a unit."""
    for k, line in enumerate(lines):
        if not line.strip() or line.lower().startswith("sep="):
            continue
        if not line.lstrip().startswith(COMMENT):
            raise TableError(
                f"{path}: line {k + 1}: is no line of numbers and names no columns, got "
                f"'{line.strip()[:80]}'. Put a line that names them above the numbers: "
                f"{_example(wanted)}."
            )
        _check_other_unit(path, k, line, wanted)


def _check_other_unit(path: Path, k: int, line: str, bare: Sequence[Column]) -> None:
    """Refuse a line of text that mentions a unit other than the one to be assumed."""
    for word in re.split(r"[\s:=,;]+", without_mark(line)):
        unit = plain_unit(re.sub(r"^[\d.+\-±]+", "", word))
        for column in bare:
            if unit != "in" and column.units.get(unit, 1.0) != 1.0:
                raise TableError(
                    f"{path}: line {k + 1}: mentions '{word}', and no unit stands with the column "
                    f"{column.name}. Name columns and units: {_example([column])}, or as it is."
                )
