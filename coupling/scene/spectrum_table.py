"""Power spectral densities of tank accelerations: a table, and what can be said of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from coupling.ports import Array, Ints
from coupling.scene.tables.columns import GRAVITY, Column
from coupling.scene.tables.file import Table, table_of
from coupling.scene.tables.text import TableError, read_content

_DENSITY = {
    **dict.fromkeys(("g2/hz", "gn2/hz", "grms2/hz"), 1.0),
    **dict.fromkeys(("m2/s3", "m2/s4/hz", "m2s-3"), GRAVITY**-2),
}
_HERTZ = dict.fromkeys(("hz", "1/s", "s-1", "cps"), 1.0)
_AXIS = r"(psd|asd|apsd|g|s|a|acc|acceleration)*(axis|achse)?{0}(axis|achse|psd|asd)?"
COLUMNS = (
    Column(name="frequency", pattern=r"f|freq|frequency|frequenz", unit="Hz", units=_HERTZ),
    *(
        Column(name=axis, pattern=_AXIS.format(axis), unit="g^2/Hz", units=_DENSITY)
        for axis in "xyz"
    ),
)


@dataclass(frozen=True, kw_only=True, eq=False)
class SpectrumTable:
    """One-sided power spectral densities of the three accelerations.

    ``frequency`` (k,) [Hz], positive and increasing; ``density`` (k, 3) [(m/s^2)^2/Hz]. Between
    two lines a density is straight in logarithms of both, as standards draw it; where it is 0 at
    either line it is straight as it is. Outside the lines it is 0. ``read``: what the file was
    taken for.
    """

    frequency: Array
    density: Array
    read: str = ""

    @cached_property
    def _slopes(self) -> Array:
        """Powers (k - 1, 3) of the frequency between two lines, NaN where either density is 0."""
        low, high = self.density[:-1], self.density[1:]
        both = (low > 0.0) & (high > 0.0)
        ratio = np.divide(high, low, out=np.ones_like(low), where=both)
        wide = np.log(self.frequency[1:] / self.frequency[:-1])[:, None]
        return np.where(both, np.log(ratio) / wide, np.nan)

    def _since(self, row: Ints, frequency: Array) -> Array:
        """Integrals (n, 3) from the lines ``row`` (n,) to the ``frequency`` (n,) behind each.

        Of S1 (f/f1)^m it is S1 f1 ((f/f1)^(m+1) - 1)/(m+1), and S1 f1 log(f/f1) for m = -1.
        """
        start, there = self.frequency[row][:, None], frequency[:, None]
        density, power = self.density[row], self._slopes[row] + 1.0
        log = np.log(there / start)
        near = np.abs(power * log) < 1e-9
        grown = np.expm1(power * log) / np.where(near, 1.0, power)
        curved = density * start * np.where(near, log, grown)
        next_, width = self.density[row + 1], self.frequency[row + 1][:, None] - start
        way = there - start
        straight = way * (density + 0.5 * (next_ - density) * way / width)
        found: Array = np.where(np.isnan(power), straight, curved)
        return found

    def power_below(self, frequency: Array) -> Array:
        """Integrals (n, 3) [(m/s^2)^2] of the densities up to ``frequency`` (n,) [Hz]."""
        rows = np.arange(len(self.frequency) - 1)
        whole = np.cumsum(self._since(rows, self.frequency[1:]), axis=0)
        before = np.vstack([np.zeros((1, 3)), whole])
        inside = np.clip(frequency, self.frequency[0], self.frequency[-1])
        row = np.clip(np.searchsorted(self.frequency, inside, side="right") - 1, 0, rows[-1])
        found: Array = before[row] + self._since(row, inside)
        return found

    @property
    def rms(self) -> Array:
        """Root of the whole power by axis (3,) [m/s^2]."""
        return np.asarray(np.sqrt(self.power_below(self.frequency[-1:])[0]))

    @cached_property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency [Hz] between which there is power; none: both are 0."""
        any_ = np.any(self.density > 0.0, axis=1)
        held = np.flatnonzero(any_[:-1] | any_[1:])
        if len(held) == 0:
            return 0.0, 0.0
        return float(self.frequency[held[0]]), float(self.frequency[held[-1] + 1])


def read_spectrum_table(path: Path) -> SpectrumTable:
    """Read a table of frequencies and densities, laid out as ``table_of`` says.

    Raises ``TableError`` as that, for frequencies that are not positive or do not increase and for
    a negative density.
    """
    return _read(path, read_content(path))


@lru_cache(maxsize=2)  # the record is made from it, and asked for again and again
def _read(path: Path, data: bytes) -> SpectrumTable:
    table = table_of(path, data, COLUMNS)
    frequency, density = table.values[:, 0], table.values[:, 1:]
    falling = np.flatnonzero(np.diff(frequency, prepend=0.0) <= 0.0)
    if len(falling) > 0:
        row = int(falling[0])
        raise TableError(
            f"{table.where(row)}: frequencies must be positive and increase, got "
            f"{frequency[row]:.10g}. Sort the lines, and leave out 0 and what is given twice."
        )
    negative = np.flatnonzero(np.any(density < 0.0, axis=1))
    if len(negative) > 0:
        row = int(negative[0])
        raise TableError(
            f"{table.where(row)}: a density must not be negative, got {density[row].min():.10g}. "
            "Give g^2/Hz, not its logarithm or decibels."
        )
    return SpectrumTable(
        frequency=frequency, density=GRAVITY**2 * density, read=_taken_for(table, len(frequency))
    )


def _taken_for(table: Table, count: int) -> str:
    """Lines and units, and where they are known from."""
    units = [unit or column.unit for unit, column in zip(table.units, COLUMNS, strict=True)]
    known = f"by the header in line {table.header}" if table.header else "the file has no header"
    assumed = "" if all(table.units) else ", missing units assumed"
    return f"{count} lines of x, y, z [{', '.join(dict.fromkeys(units[1:]))}] ({known}{assumed})"
