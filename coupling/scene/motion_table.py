"""Accelerations of a tank over time, and what can be said of them.

Of a tank that turns there are angular rates or angles as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from coupling.ports import Array

NEAR_GRAVITY = 0.1  # of gravity: how near to it a median is taken to contain it
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
