"""``coupling.csv``: one line an iteration, on the disk as soon as it is computed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from coupling.ports import Array, RunFailed
from coupling.store.atomic import write_text

FILE = "coupling.csv"
_HEADER = "time,iteration,residual,seconds\n"


class IterationLog:
    """Appends to ``coupling.csv``: time [s], iteration, residual, wall time it took [s].

    Of every try: where a step failed, its parts follow, each with a time of its own.
    """

    def __init__(self, folder: Path | str, *, kept: Iterable[str] = ()) -> None:
        self._path = Path(folder) / FILE
        self._path.parent.mkdir(parents=True, exist_ok=True)
        write_text(self._path, _HEADER + "".join(f"{line}\n" for line in kept))
        self._file = self._path.open("a", encoding="utf-8", buffering=1)

    @classmethod
    def resume(cls, folder: Path | str, *, until: float) -> IterationLog:
        """Go on after dropping the lines later than ``until`` [s], and a torn last one."""
        path = Path(folder) / FILE
        lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
        latest = until + 1e-9 * max(1.0, abs(until))
        return cls(
            folder, kept=[line for line in lines[1:] if (row := _row(line)) and row[0] <= latest]
        )

    def write(self, time: float, iteration: int, residual: float, seconds: float) -> None:
        """Append one iteration; raises RunFailed when the disk is full."""
        try:
            self._file.write(f"{time:.9g},{iteration},{residual:.6e},{seconds:.6f}\n")
        except OSError as error:
            raise RunFailed(
                f"{self._path}: cannot be written: {error}. Make room, then `edt resume`."
            ) from error

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def read_iterations(folder: Path | str) -> Array:
    """Rows (k, 4) of ``coupling.csv``: time, iteration, residual, seconds; torn lines are left out.

    No file gives no rows.
    """
    path = Path(folder) / FILE
    lines = path.read_text(encoding="utf-8").splitlines()[1:] if path.is_file() else []
    rows = [row for line in lines if (row := _row(line))]
    return np.array(rows, dtype=float).reshape(-1, 4)


def _row(line: str) -> tuple[float, ...] | None:
    try:
        row = tuple(float(cell) for cell in line.split(","))
    except ValueError:
        return None
    return row if len(row) == 4 else None
