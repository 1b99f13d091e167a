"""First harmonic of a signal, against the tank's motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coupling.ports import Array

BAND = 4  # highest harmonic in the band of the motion; blows lie above, and what steps add
_ZERO = 1e-5  # of the largest component: below it a phase is the solver's noise


@dataclass(frozen=True, kw_only=True)
class Harmonic:
    """x(t) = mean + amplitude cos(omega t + angle), of k signals.

    ``coefficient`` (k,) = amplitude e^(i angle), complex; ``mean`` (k,); ``periods``: how many
    whole periods were fitted.
    """

    coefficient: NDArray[np.complex128]
    mean: Array
    periods: int

    @property
    def amplitude(self) -> Array:
        """Amplitude (k,) of every signal, in the signal's unit."""
        return np.abs(self.coefficient)

    def phase_deg(self, reference: complex) -> list[float | None]:
        """Return the angles against ``reference`` in (-180, 180], negative where a signal lags.

        None for a component of no amplitude, or without a reference.
        """
        smallest = _ZERO * float(self.amplitude.max(initial=0.0))
        if reference == 0.0:
            return [None] * len(self.coefficient)
        return [
            float(np.degrees(np.angle(value / reference))) if abs(value) > smallest else None
            for value in self.coefficient
        ]


def last_whole_periods(
    time: Array, frequency: float, start: float = 0.0
) -> tuple[NDArray[np.bool_], int]:
    """Return which instants (T,) to fit, and how many periods they span.

    The later half of the whole periods after ``start`` [s], where the shaking has reached its
    amplitude, one at the least; of a run that ends before, its last whole period. Half open, so
    that evenly spaced instants count every phase once. None of them, and 0, when the run is
    shorter than a period or has fewer than 4 instants in it.
    """
    nothing = np.zeros(len(time), dtype=bool)
    if len(time) < 4:
        return nothing, 0
    end = float(time[-1])
    steady = int((end - start) * frequency * (1.0 + 1e-9))
    whole = int((end - float(time[0])) * frequency * (1.0 + 1e-9))
    periods = max(1, steady // 2) if steady >= 1 else min(whole, 1)
    chosen = time > end - periods / frequency * (1.0 - 1e-9)
    if periods == 0 or chosen.sum() < 4 * periods:
        return nothing, 0
    return chosen, periods


def first_harmonic(time: Array, signal: Array, frequency: float, *, periods: int) -> Harmonic:
    """Fit a constant, a cosine and a sine of one frequency to signals, by least squares.

    Parameters
    ----------
    time
        Instants (N,) [s], in any order and spacing that tells the three functions apart.
    signal
        Signals (N, k), of any unit.
    frequency
        Frequency [Hz] of cosine and sine.
    periods
        Number of whole periods that the instants span: kept in the result, not used in the fit.

    Returns
    -------
    Harmonic
        Complex coefficients (k,) and means (k,), in the unit of the signals.

    Notes
    -----
    Exact, up to rounding, for such signals at any instants that tell them apart. Noise of standard
    deviation s leaves s sqrt(2/N) in the amplitude. Higher harmonics leave nothing at evenly spaced
    instants over whole periods; a frequency in between, such as free sloshing that has not died
    away, leaks in the order of its amplitude over the number of periods.
    """
    angle = 2.0 * np.pi * frequency * time
    basis = np.stack([np.ones_like(angle), np.cos(angle), np.sin(angle)], axis=1)
    fitted = np.linalg.lstsq(basis, signal, rcond=None)[0]
    return Harmonic(coefficient=fitted[1] - 1j * fitted[2], mean=fitted[0], periods=periods)


def spans_two_periods(time: Array, frequency: float) -> bool:
    """Whether the instants (N,) [s] span two periods of ``frequency`` [Hz]."""
    return len(time) > 0 and bool((time[-1] - time[0]) * frequency >= 2.0 * (1.0 - 1e-9))


def phasor_drift(time: Array, signal: Array, frequency: float) -> float | None:
    """Return by how much the first harmonic changed from the last period but one to the last.

    Parameters
    ----------
    time
        Instants (N,) [s].
    signal
        Signals (N, k), of any unit; their phasors are taken as one vector.
    frequency
        Frequency [Hz] of the harmonic.

    Returns
    -------
    float or None
        |c_last - c_before|/|c_last| [-]; None with less than two periods, with fewer than 4
        instants in either, or where nothing moves.
    """
    if not spans_two_periods(time, frequency):
        return None
    ago = (time[-1] - time) * frequency  # periods
    phasors = []
    for start in (1.0, 0.0):
        chosen = (ago > start - 1e-9) & (ago < start + 1.0 - 1e-9)
        if chosen.sum() < 4:
            return None
        fit = first_harmonic(time[chosen], signal[chosen], frequency, periods=1)
        phasors.append(fit.coefficient)
    before, last = phasors
    size = float(np.linalg.norm(last))
    return float(np.linalg.norm(last - before)) / size if size > 0.0 else None
