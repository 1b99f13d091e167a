"""Spectra of a run's signals, and what of them lies in bands of frequency."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import welch

from coupling.ports import Array

_SEGMENTS = 4  # lengths of a segment in the record; half overlapping, they are 7
FEWEST = 64  # instants from which on a spectrum says something
_LINES = 2  # of the spectrum below the first octave: a window smears each over as many either way


@dataclass(frozen=True, kw_only=True)
class Spectrum:
    """One-sided power spectral densities of k signals about their means.

    ``frequency`` (m,) [Hz], evenly spaced from 0; ``density`` (m, k) [unit^2/Hz]; ``duration`` of
    the record [s].
    """

    frequency: Array
    density: Array
    duration: float

    @property
    def line(self) -> float:
        """Width of a line [Hz]: four over the record's length."""
        return float(self.frequency[1])

    def power(self, band: tuple[float, float]) -> Array:
        """Power (k,) [unit^2] of the lines in ``band`` [Hz], the lower end counted in."""
        found: Array = self.line * self.density[self._inside(band)].sum(axis=0)
        return found

    def random_error(self, band: tuple[float, float]) -> float:
        """Relative standard deviation of a band's rms between records of the same random process.

        1/(2 sqrt(B T)) of a band of width B in a record of length T (Bendat and Piersol, Random
        Data, 4th edition, section 8.2), for a density that is even in the band. Of this record
        itself the rms is known better.
        """
        width = self.line * int(self._inside(band).sum())
        return 0.5 / math.sqrt(width * self.duration)

    def _inside(self, band: tuple[float, float]) -> NDArray[np.bool_]:
        return (self.frequency >= band[0]) & (self.frequency < band[1])


def spectrum_of(time: Array, signal: Array) -> Spectrum | None:
    """Welch's estimate of the spectrum, from segments of a quarter of the record.

    Hann windows, half overlapping, each segment less its own mean (Welch, IEEE Trans. Audio and
    Electroacoustics 15, 1967). Instants that are not evenly spaced are interpolated.

    Parameters
    ----------
    time
        Instants (S,) [s], increasing.
    signal
        Signals (S, k), of any units.

    Returns
    -------
    Spectrum or None
        None of fewer than 64 instants.
    """
    count = len(time)
    if count < FEWEST:
        return None
    duration = float(time[-1] - time[0])
    step = duration / (count - 1)
    even = time[0] + step * np.arange(count)
    if np.abs(even - time).max() > 1e-6 * step:
        signal = np.stack([np.interp(even, time, part) for part in signal.T], axis=1)
    frequency, density = welch(
        signal, 1.0 / step, window="hann", nperseg=count // _SEGMENTS, axis=0, detrend="constant"
    )
    return Spectrum(frequency=frequency, density=density, duration=duration)


def octaves(spectrum: Spectrum) -> list[tuple[float, float]]:
    """Bands [Hz] that a ``spectrum`` is taken apart by: octaves between powers of 2.

    The first holds all below the first power of 2 that two lines lie below; the last ends with the
    spectrum.
    """
    highest = float(spectrum.frequency[-1]) + spectrum.line
    first = math.ceil(math.log2(_LINES * spectrum.line))
    edges = [0.0]
    while 2.0**first < highest - spectrum.line:
        edges.append(2.0**first)
        first += 1
    edges.append(highest)
    return list(pairwise(edges))
