"""Times of a table's lines: seconds, other units, dates, hours of the day, seconds since 1970."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from coupling.ports import Array
from coupling.scene.tables.text import TableError

if TYPE_CHECKING:
    from pandas import Series

_SINCE_1970 = 1e8, 1e10  # seconds: from 1973 to 2286
_EPOCH_UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def seconds_of_numbers(
    values: Array, unit: str, factor: float, where: str
) -> tuple[Array, str | None]:
    """Times [s], and when they start where they were counted from 1970.

    ``values`` (k,), integers where they are, so that nothing is lost; ``unit`` "" where the file
    gives none. Times from 1970 are made to start at 0.

    Raises ``TableError``, which begins with ``where``, for a unit in which they were no times.
    """
    first = float(values[0])
    low, high = _SINCE_1970
    start = factor * first
    if unit == "" and first >= low:
        name = next((name for name, size in _EPOCH_UNITS.items() if size * first < high), "")
        factor, start, unit = _EPOCH_UNITS.get(name, 1.0), _EPOCH_UNITS.get(name, 1.0) * first, name
    if start >= high:
        raise TableError(
            f"{where}: time is {first:.15g} {unit}, which is no date. Give the unit of time in the "
            "header, such as time (ms)."
        )
    if start < low:
        return factor * np.asarray(values, dtype=np.float64), None
    since = factor * np.asarray(values - values[0], dtype=np.float64)
    text = f"{values[0]:.15g}" if values.dtype.kind == "f" else str(values[0])
    return since, f"{text} {unit} since 1970"


def seconds_of_dates(cells: Series[str]) -> Array:
    """Seconds since the first of ISO 8601 dates or hours of the day; NaN for what is neither."""
    import pandas as pd

    cells = cells.str.strip().str.replace(",", ".", regex=False)
    times = pd.to_datetime(cells, format="ISO8601", utc=True, errors="coerce")
    if times.isna().iloc[0]:
        times = pd.to_timedelta(cells.where(cells.str.count(":") == 2), errors="coerce")
    since = (times - times.iloc[0]).dt.total_seconds()
    return np.asarray(since, dtype=np.float64)
