"""How the tank is shaken to be identified, and to be held against what was identified.

All motions start from rest and are given at even instants; ``slosh`` is the first slosh frequency
f1 [Hz] by which frequencies, times and steps are scaled.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.interpolate import make_interp_spline

from coupling.motion.sine import smooth_ramp
from coupling.ports import Array

LOW, HIGH = 0.4, 2.6  # over f1: ends of a sweep; the second mode lies at 1.2 to 2, see the docs
SWEEP, COAST = 12.0, 3.0  # periods of f1 that a sweep takes, and that the tank stands after it
STEPS_A_PERIOD = 100  # of f1: 38 in a period of the highest frequency
EDGE = 1.0  # periods of f1 in which a sweep grows and dies
RECORD_LINES = 24  # sines of random phase that the record for validation is made of
RECORD_BAND = (0.4, 1.6)  # over f1
_FINE = 8  # instants a step of the displacement that is differentiated


def sweep(amplitude: float, slosh: float, step: float, *, upwards: bool) -> Array:
    """Acceleration (n,) [m/s^2] of a sine of even amplitude whose frequency changes evenly.

    The displacement's amplitude [m] is that of sines of all frequencies between ``LOW`` and
    ``HIGH`` f1, so a sweep's figures are of the amplitude that forced sines would have.
    ``step`` [s] between the instants.
    """
    length = SWEEP / slosh

    def displacement(time: Array) -> Array:
        low, high = (LOW, HIGH) if upwards else (HIGH, LOW)
        turns = slosh * (low * time + 0.5 * (high - low) / length * time**2)
        return np.asarray(amplitude * _gated(time, length, slosh) * np.sin(2.0 * np.pi * turns))

    return _acceleration(displacement, (SWEEP + COAST) / slosh, step)


def random_record(amplitude: float, slosh: float, step: float) -> Array:
    """Acceleration (n,) [m/s^2] of a record that no fit has seen: sines of random phase.

    Their frequencies lie evenly in ``RECORD_BAND``, their accelerations are alike, and the largest
    displacement of the tank is ``amplitude`` [m]. The phases are the same every time.
    """
    length = SWEEP / slosh
    generator = np.random.default_rng(2025)
    frequencies = slosh * (
        np.linspace(*RECORD_BAND, RECORD_LINES) + 0.02 * generator.random(RECORD_LINES)
    )
    phases = 2.0 * np.pi * generator.random(RECORD_LINES)

    def displacement(time: Array) -> Array:
        waves = np.sin(2.0 * np.pi * np.outer(time, frequencies) + phases) / frequencies**2
        return np.asarray(_gated(time, length, slosh) * waves.sum(axis=1))

    largest = np.abs(displacement(np.arange(0.0, length, step))).max()
    scale = float(amplitude / largest)
    return scale * _acceleration(displacement, (SWEEP + COAST) / slosh, step)


def _gated(time: Array, length: float, slosh: float) -> Array:
    """1 within 0 to ``length`` [s], with smooth edges."""
    edge = EDGE / slosh
    return np.array([smooth_ramp(t, edge)[0] * smooth_ramp(length - t, edge)[0] for t in time])


def _acceleration(displacement: Callable[[Array], Array], length: float, step: float) -> Array:
    """Second derivative at the instants, by a spline of fifth degree through finer ones."""
    count = round(length / step)
    fine = np.linspace(0.0, step * count, _FINE * count + 1)
    curve = make_interp_spline(fine, displacement(fine), k=5).derivative(2)
    found = np.asarray(curve(step * np.arange(count + 1)), dtype=np.float64)
    found[0] = 0.0  # by the ramp, but for the spline's rounding
    return found
