"""Rows that go to the end of a file in two copies, held until both have them."""

from __future__ import annotations

from typing import Generic, TypeVar

Row = TypeVar("Row")


class WaitingRows(Generic[Row]):
    """Rows of an ``AlternatingFile``: those last written, which a second copy lacks, and new ones.

    ``written``: how many rows stand in the file already.
    """

    def __init__(self, written: int) -> None:
        self._written = written
        self.first = written  # number of the first row of ``kept``
        self.kept: list[Row] = []

    def __len__(self) -> int:
        """Number of rows taken, those in the file included."""
        return self.first + len(self.kept)

    @property
    def wait(self) -> bool:
        """Whether there are rows that are not in the file."""
        return len(self) > self._written

    def after(self, there: int) -> list[Row]:
        """Return the rows that a copy with ``there`` of them lacks."""
        return self.kept[there - self.first :]

    def note_written(self) -> None:
        """All rows are in the file now; forget those that its second copy has too."""
        rows = len(self)
        del self.kept[: self._written - self.first]
        self.first, self._written = self._written, rows
