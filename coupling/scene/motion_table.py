"""Measured tank accelerations: a table of time, ax, ay and az, and what can be said of it.

Of a tank that turns it has angular rates or angles as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np

from coupling.ports import Array
from coupling.scene.tables.columns import ACCELERATION, ANGLE, RATE, TIME, Column
from coupling.scene.tables.file import Table, table_of
from coupling.scene.tables.text import TableError, read_content

_AXIS = (
    r"(linear)?(a|acc|accel|accelerometer|acceleration|beschleunigung|beschl)?"
    r"(axis|achse)?{0}(axis|achse|acc|accel|acceleration)?"
)
COLUMNS = (
    Column(
        name="time",
        pattern=r"t|time|times?stamps?|zeit|datetime|elapsed|elapsedtime|timeelapsed|relativetime"
        r"|utc|utctime|epoch|epochtime|unixtime|isotime|localtime",
        unit="s",
        units=TIME,
        clock=True,
    ),
    *(
        Column(name=f"a{axis}", pattern=_AXIS.format(axis), unit="m/s^2", units=ACCELERATION)
        for axis in "xyz"
    ),
)
_RATE = (
    r"(w|omega|gyro|gyr|gyroscope|angularrate|angularvelocity|angvel|drehrate)(axis|achse)?{0}"
    r"(axis|achse)?"
)
RATES = tuple(
    Column(name=f"w{axis}", pattern=_RATE.format(axis), unit="deg/s", units=RATE) for axis in "xyz"
)
ANGLES = tuple(
    Column(name=name, pattern=pattern, unit="deg", units=ANGLE)
    for name, pattern in (
        ("roll", r"roll(angle|winkel)?|wank(winkel)?"),
        ("pitch", r"pitch(angle|winkel)?|nick(winkel)?"),
        ("yaw", r"yaw(angle|winkel)?|gier(winkel)?"),
    )
)
NEAR_GRAVITY = 0.1  # of gravity: how near to it a median is taken to contain it
_MANY = 10  # samples from which on a record's rate says something
_GAP = 2.5  # times the median step: more than one sample is missing
_FEW = 0.05  # share of the steps up to which longer ones are gaps, beyond it the sampling is uneven
_SLOWEST = 0.5  # s between samples, above which a time without a unit may be milliseconds


POWER = 0.9  # of a table's acceleration: the share that lies below its characteristic frequency


@dataclass(frozen=True, kw_only=True, eq=False)
class MotionTable:
    """``time`` (k,) [s], strictly increasing; ``acceleration`` (k, 3) [m/s^2], linear in between.

    ``read``: what the file was taken for; ``units_given``: whether it names its units. Of a tank
    that turns ``rates`` (k, 3) [rad/s] or ``angles`` (k, 3) [rad], roll, pitch and yaw; all
    vectors are then in the tank's own axes.
    """

    time: Array
    acceleration: Array
    read: str = ""
    units_given: bool = True
    rates: Array | None = None
    angles: Array | None = None

    @property
    def turns(self) -> bool:
        """Whether it has angular rates or angles."""
        return self.rates is not None or self.angles is not None

    def less(self, constant: Sequence[float]) -> MotionTable:
        """The same less a ``constant`` acceleration (3,) [m/s^2]."""
        said = ", ".join(f"{value:g}" for value in constant)
        read = f"{self.read}, less ({said}) m/s^2" if any(constant) else self.read
        return replace(self, acceleration=self.acceleration - np.array(constant), read=read)

    @cached_property
    def mean(self) -> Array:
        """Mean acceleration (3,) [m/s^2] over time."""
        middle = 0.5 * (self.acceleration[1:] + self.acceleration[:-1])
        return np.asarray(np.diff(self.time) @ middle / (self.time[-1] - self.time[0]))

    @cached_property
    def _spectrum(self) -> tuple[Array, Array]:
        """Frequencies (m,) [Hz] and the power (m,) up to each, of all axes, the mean left out."""
        from scipy.fft import next_fast_len  # takes long to import, and few scenes need it

        count = max(len(self.time) - 1, 64)
        even = np.linspace(self.time[0], self.time[-1], count, endpoint=False)
        signal = np.stack([np.interp(even, self.time, part) for part in self.acceleration.T])
        signal -= signal.mean(axis=1, keepdims=True)
        padded = next_fast_len(count, real=True)
        lines = np.fft.rfft(signal, n=padded)
        power = np.sum(lines.real**2 + lines.imag**2, axis=0)
        return np.fft.rfftfreq(padded, even[1] - even[0]), np.cumsum(power)

    @property
    def median(self) -> Array:
        """Median (3,) [m/s^2] of the samples, which shocks do not move."""
        return np.asarray(np.median(self.acceleration, axis=0))

    @cached_property
    def rms(self) -> Array:
        """Root mean square (3,) [m/s^2] about 0, of the lines between the samples, over time."""
        low, high = self.acceleration[:-1], self.acceleration[1:]
        squares = (low**2 + low * high + high**2) / 3.0
        mean = np.diff(self.time) @ squares / (self.time[-1] - self.time[0])
        return np.asarray(np.sqrt(mean))

    @property
    def characteristic_frequency(self) -> float:
        """Frequency [Hz] below which POWER of the power lies, resolved to one over the length.

        0 where nothing changes.
        """
        return self._frequency_of(POWER)

    @property
    def band(self) -> tuple[float, float]:
        """Frequencies [Hz] between which POWER of the power lies, as much below as above."""
        return self._frequency_of(0.5 * (1.0 - POWER)), self._frequency_of(0.5 * (1.0 + POWER))

    def _frequency_of(self, share: float) -> float:
        """Frequency [Hz] below which a ``share`` of the power lies, 0 where nothing changes."""
        frequencies, power = self._spectrum
        if power[-1] <= 0.0:
            return 0.0
        return float(frequencies[np.searchsorted(power, share * power[-1])])

    def power_above(self, frequency: float) -> float:
        """Share of the power that lies above ``frequency`` [Hz]; 0 where nothing changes."""
        frequencies, power = self._spectrum
        below = np.searchsorted(frequencies, frequency, side="right") - 1
        return 0.0 if power[-1] <= 0.0 else float(1.0 - power[below] / power[-1])


def read_motion_table(path: Path) -> MotionTable:
    """Read a table of accelerations, laid out as ``table_of`` says.

    Times that are dates, or seconds since 1970, start at 0. Raises ``TableError`` as that, for
    times that do not increase, for times without a unit that are so far apart that they may be
    milliseconds, and for gaps of more than one sample. Whether the samples resolve the motion is
    not checked.
    """
    return _read(path, read_content(path))


@lru_cache(maxsize=2)  # a study asks for the same record again and again
def _read(path: Path, data: bytes) -> MotionTable:
    table, turning = _with_rotation(path, data, table_of(path, data, COLUMNS))
    time = table.values[:, 0]
    unordered = np.flatnonzero(np.diff(time) <= 0.0)
    if len(unordered) > 0:
        row = int(unordered[0]) + 1
        more = f" (and {len(unordered) - 1} more lines)" if len(unordered) > 1 else ""
        raise TableError(
            f"{table.where(row)}: time must increase, got {time[row]:.10g} after "
            f"{time[row - 1]:.10g}{more}. Sort the lines and remove repeated times."
        )
    apart = float(np.median(np.diff(time)))
    if len(time) >= _MANY and apart >= _SLOWEST and not table.units[0] and table.start is None:
        raise TableError(
            f"{table.where(1)}: time steps by {apart:.4g}, and the file gives no unit of time. "
            "Name it in a header, such as time (ms), ax (m/s^2), ay (m/s^2), az (m/s^2)."
        )
    _check_gaps(table)
    rotation = np.radians(table.values[:, 4:])
    return MotionTable(
        time=time,
        acceleration=table.values[:, 1:4],
        read=_taken_for(table, turning),
        units_given=all(table.units[1:4]),
        rates=rotation if turning is RATES else None,
        angles=rotation if turning is ANGLES else None,
    )


def _with_rotation(path: Path, data: bytes, table: Table) -> tuple[Table, tuple[Column, ...]]:
    """The ``table`` with the columns of rotation that its header names, and which these are.

    Raises ``TableError`` where it names some of three only, rates and angles, or no unit.
    """
    rates, angles = (
        [c.name for c in group if any(c.read(name) is not None for name in table.others)]
        for group in (RATES, ANGLES)
    )
    if not (rates or angles):
        return table, ()
    where = f"{path}: line {table.header}"
    if rates and angles:
        raise TableError(
            f"{where}: names angular rates and angles, {rates[0]} and {angles[0]} among them. "
            "Leave one of the two out: either says how the tank turns."
        )
    group = RATES if rates else ANGLES
    names = ", ".join(column.name for column in group)
    missing = [column.name for column in group if column.name not in (*rates, *angles)]
    if missing:
        raise TableError(
            f"{where}: names no column {', '.join(missing)} of a tank that turns. Give {names}, "
            "with zeros about an axis that it does not turn about, or rename what is none of them."
        )
    whole = table_of(path, data, (*COLUMNS, *group))
    bare = [c.name for c, unit in zip(group, whole.units[4:], strict=True) if not unit]
    if bare:
        raise TableError(
            f"{where}: gives no unit of {', '.join(bare)}. Write it there, such as {bare[0]} "
            f"({group[0].unit}); nothing is assumed of rotation."
        )
    return whole, group


def _check_gaps(table: Table) -> None:
    """Refuse what a logger has left out; equal values at both ends are a tank that coasts."""
    steps = np.diff(table.values[:, 0])
    changed = np.any(table.values[1:, 1:] != table.values[:-1, 1:], axis=1)
    rows = np.flatnonzero((steps > _GAP * np.median(steps)) & changed)
    if len(steps) < _MANY or not 0 < len(rows) <= _FEW * len(steps):
        return
    row = int(rows[0])
    more = f" (and {len(rows) - 1} more gaps)" if len(rows) > 1 else ""
    raise TableError(
        f"{table.where(row + 1)}: {steps[row]:.3g} s are missing since line {table.lines[row]}, "
        f"where samples are {np.median(steps):.3g} s apart{more}. Fill the gap, with the line "
        "between its ends if that is meant, or give the part before or behind it."
    )


def _taken_for(table: Table, turning: tuple[Column, ...]) -> str:
    """Columns and units, and where they are known from; ``turning``: those of rotation."""
    units = [unit or column.unit for unit, column in zip(table.units[:4], COLUMNS, strict=True)]
    time = f"time [{units[0]}]" if table.start is None else f"time from {table.start} on"
    pairs = zip(COLUMNS[1:], units[1:], strict=True)
    axes = ", ".join(f"{column.name} [{unit}]" for column, unit in pairs)
    if len(set(units[1:])) == 1:
        axes = f"ax, ay, az [{units[1]}]"
    if turning:
        pairs = zip(turning, table.units[4:], strict=True)
        axes += ", " + ", ".join(f"{column.name} [{unit}]" for column, unit in pairs)
        axes += ", all about the tank's own axes"
    known = all(table.units[1:]) and bool(table.units[0] or table.start)
    if table.header == 0:
        source = "columns and units assumed: the file has no header"
    else:
        source = f"by the header in line {table.header}{'' if known else ', missing units assumed'}"
    unused = f", not used: {', '.join(table.others)}" if table.others else ""
    return f"{time}, {axes} ({source}{unused})"
