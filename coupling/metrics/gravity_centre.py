"""How the liquid's centre of gravity moves, and what that says of the hydrostatic assumption."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coupling.ports import Array

_STILL = 1e-12  # m/s^2


def peak_amplitude(signal: Array) -> Array:
    """Half of the peak-to-peak range of ``signal`` (T, k), (k,); for motions without a period."""
    return np.asarray(0.5 * np.ptp(signal, axis=0), dtype=np.float64)


def neglected_momentum(
    cg: NDArray[np.complex128], displacement: NDArray[np.complex128]
) -> float | None:
    """Amplitude of c'' over amplitude of a_tank, both harmonic with one frequency.

    ``cg``, ``displacement`` (3,) [m]: complex first harmonics in the tank frame and of the tank.
    The force on the liquid is m (a_tank + c''), so this is exactly the part that an assumption of
    c'' = 0 leaves out. omega^2 cancels; the CG counts along the direction of shaking only.
    None when the tank does not move.
    """
    size = float(np.linalg.norm(displacement))
    if size == 0.0:
        return None
    along = np.vdot(displacement, cg) / size
    return float(abs(along)) / size


def neglected_momentum_transient(time: Array, cg: Array, tank_acceleration: Array) -> float | None:
    """The same for a motion without a period: largest |c''| over largest |a_tank|.

    ``time`` (T,) [s]; ``cg`` [m], ``tank_acceleration`` [m/s^2] (T, 3). c'' comes from second
    differences of what was written out: noise e in the CG gives 4 e/h^2, and anything faster than
    some 5 instants is lost. None with fewer than 3 instants or a tank that does not move.
    """
    largest = float(np.linalg.norm(tank_acceleration, axis=1).max(initial=0.0))
    if len(time) < 3 or largest < _STILL:
        return None
    slope = np.diff(cg, axis=0) / np.diff(time)[:, None]
    middle = 0.5 * (time[1:] + time[:-1])
    second = np.diff(slope, axis=0) / np.diff(middle)[:, None]
    return float(np.linalg.norm(second, axis=1).max()) / largest
