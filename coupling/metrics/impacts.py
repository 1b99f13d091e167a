"""Impulses of the force within an eighth of a period, which converge where its peaks do not."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.integrate import cumulative_trapezoid
from scipy.signal import find_peaks

from coupling.ports import Array

_WINDOW = 0.125  # of a period: a blow is shorter, and what the sway itself does in it is little
_COUNTED = 0.5  # share of the largest impulse from which on a blow counts
_ROUNDING = 1e-9  # of the weight's impulse in an eighth, below which there is none


def impacts(
    time: Array, force: Array, *, body_force: Array, mass: float, frequency: float
) -> dict[str, Any] | None:
    """Return the largest impulse of the force within an eighth of a period, and how many there are.

    Of what the force has beyond that of a rigid liquid, F - m b: the change of the liquid's
    momentum in the tank. A blow has the same impulse however high and narrow the steps draw it; a
    smooth slosh has one to either side in every period.

    Parameters
    ----------
    time
        Instants (S,) [s], increasing.
    force
        Force of the liquid (S, 3) [N].
    body_force
        g less the tank's acceleration b (S, 3) [m/s^2].
    mass
        Mass of the liquid m [kg].
    frequency
        Frequency of the shaking [Hz].

    Returns
    -------
    dict or None
        ``impulse_max_Ns`` [N s] and ``time_of_max_s`` [s], the middle of its eighth; ``number`` of
        eighths, apart by one at least, with half of that impulse or more. None for a run that is
        shorter than an eighth of a period.
    """
    window = _WINDOW / frequency
    if len(time) < 3 or time[-1] - time[0] <= window:
        return None
    rest = force - mass * body_force
    gathered = cumulative_trapezoid(rest, time, axis=0, initial=0)
    middle = np.arange(time[0] + 0.5 * window, time[-1] - 0.5 * window, window / 32.0)

    def at(instants: Array) -> Array:
        return np.stack([np.interp(instants, time, part) for part in gathered.T], axis=1)

    change = at(middle + 0.5 * window) - at(middle - 0.5 * window)
    size = np.linalg.norm(change, axis=1)
    largest = int(size.argmax())
    padded = np.concatenate([[0.0], size, [0.0]])  # a largest one at an end is one as well
    peaks, _ = find_peaks(padded, height=_COUNTED * size[largest], distance=32)
    least = _ROUNDING * mass * float(np.linalg.norm(body_force, axis=1).max()) * window
    return {
        "impulse_max_Ns": float(size[largest]),
        "time_of_max_s": float(middle[largest]),
        "number": len(peaks) if size[largest] > least else 0,
    }
