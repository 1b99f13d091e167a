"""A table on stdout, and figures as text."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from rich.console import Console
from rich.table import Table


def print_table(title: str, heads: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print a table on stdout, first column left, others right."""
    table = Table(title=title or None, title_justify="left")
    for index, head in enumerate(heads):
        first = index == 0
        table.add_column(head, justify="left" if first else "right", overflow="fold", no_wrap=first)
    for row in rows:
        table.add_row(*row)
    console = Console(markup=False, highlight=False, emoji=False)
    if not console.is_terminal:
        console.width = max(console.width, 100)
    console.print(table)


def figure(value: Any, digits: int = 4) -> str:
    """A number to ``digits``, a dash where there is none, lists element by element."""
    if value is None or value != value:
        return "-"
    if isinstance(value, list | tuple):
        return ", ".join(figure(item, digits) for item in value)
    return f"{value:.{digits}g}" if isinstance(value, float) else str(value)
