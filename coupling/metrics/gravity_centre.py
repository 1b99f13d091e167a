"""How the liquid's centre of gravity moves, and what that says of the hydrostatic assumption."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coupling.ports import Array

_STILL = 1e-12  # m/s^2


def peak_amplitude(signal: Array) -> Array:
    """Return half of the peak-to-peak range (k,) of ``signal`` (T, k), in the signal's unit.

    For motions without a period.
    """
    return np.asarray(0.5 * np.ptp(signal, axis=0), dtype=np.float64)


def neglected_momentum(
    cg: NDArray[np.complex128], displacement: NDArray[np.complex128]
) -> float | None:
    """Return the amplitude of c'' over that of a_tank, both harmonic with one frequency.

    The force on the liquid is m (a_tank + c''), so this is exactly the part that an assumption of
    c'' = 0 leaves out. omega^2 cancels; the CG counts along the direction of shaking only.

    Parameters
    ----------
    cg
        Complex first harmonic of the liquid's CG in the tank frame (3,) [m].
    displacement
        Complex first harmonic of the tank's displacement (3,) [m].

    Returns
    -------
    float or None
        The ratio [-]; None when the tank does not move.
    """
    size = float(np.linalg.norm(displacement))
    if size == 0.0:
        return None
    along = np.vdot(displacement, cg) / size
    return float(abs(along)) / size


def neglected_momentum_transient(time: Array, cg: Array, tank_acceleration: Array) -> float | None:
    """Return the largest |c''| over the largest |a_tank|, for a motion without a period.

    The counterpart of ``neglected_momentum``, here of all components.

    Parameters
    ----------
    time
        Ends of steps (T,) [s], increasing, not necessarily evenly spaced.
    cg
        The liquid's CG c in the tank frame (T, 3) [m].
    tank_acceleration
        Acceleration a_tank of the tank (T, 3) [m/s^2].

    Returns
    -------
    float or None
        The ratio [-]; None with fewer than 3 instants or a tank that does not move, |a_tank| below
        1e-12 m/s^2.

    Notes
    -----
    c'' comes from second differences over steps of h: noise e in the CG gives 4 e/h^2, and anything
    faster than some 5 steps is lost.
    """
    largest = float(np.linalg.norm(tank_acceleration, axis=1).max(initial=0.0))
    if len(time) < 3 or largest < _STILL:
        return None
    slope = np.diff(cg, axis=0) / np.diff(time)[:, None]
    middle = 0.5 * (time[1:] + time[:-1])
    second = np.diff(slope, axis=0) / np.diff(middle)[:, None]
    return float(np.linalg.norm(second, axis=1).max()) / largest
