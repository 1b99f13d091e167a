"""A run's progress on stderr: a bar in a terminal, a line now and then elsewhere."""

from __future__ import annotations

import time
from contextlib import suppress
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

_LINES_EVERY = 30.0  # seconds


class RunProgress:
    """Context manager; call it with (stage, done, total, text).

    ``done`` and ``total`` are in ``unit``: seconds, or whole things of that name; a ``total`` of 0
    stands for a stage whose end is not known beforehand.
    Outside a terminal a line appears when the stage changes, then every 30 seconds and at its end.
    """

    def __init__(self, console: Console | None = None, *, unit: str = "s") -> None:
        self._unit, self._digits = unit, ".3f" if unit == "s" else "g"
        self._console = console or Console(stderr=True)
        self._bar: Progress | None = None
        self._task: TaskID | None = None
        self._stage = ""
        self._last_line = 0.0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._bar is not None:
            with suppress(OSError):
                self._bar.stop()

    def __call__(self, stage: str, done: float, total: float, text: str) -> None:
        """Show how far ``stage`` is, where there still is somebody to see it."""
        if total > 0.0:
            text = f"{done:{self._digits}} / {total:{self._digits}} {self._unit} {text}".rstrip()
        with suppress(OSError):  # a terminal that was closed does not end a run
            self._show(stage, done, total, text)

    def _show(self, stage: str, done: float, total: float, text: str) -> None:
        if self._console.is_terminal:
            self._advance(stage, done, total, text)
        else:
            self._line(stage, done, total, text)
        self._stage = stage

    def _advance(self, stage: str, done: float, total: float, text: str) -> None:
        if self._bar is None:  # not before: where nothing is computed there is none
            self._bar = _bar(self._console)
            self._bar.start()
        if self._task is None or stage != self._stage:
            if self._task is not None and self._bar.tasks[self._task].total is None:
                self._bar.update(self._task, total=1.0, completed=1.0)  # else it looks unfinished
            self._task = self._bar.add_task(stage, total=total or None, text=text)
            self._bar.update(self._task, completed=done)
        else:
            self._bar.update(self._task, total=total or None, completed=done, text=text)

    def _line(self, stage: str, done: float, total: float, text: str) -> None:
        now = time.monotonic()
        if stage == self._stage and done < total and now - self._last_line < _LINES_EVERY:
            return
        self._last_line = now
        self._console.print(f"{stage}: {text}", highlight=False, markup=False, soft_wrap=True)


def _bar(console: Console) -> Progress:
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.fields[text]}", markup=False),
        TimeElapsedColumn(),
        TimeRemainingColumn(),
        console=console,
    )
