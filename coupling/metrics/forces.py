"""Forces of the liquid on tank and diaphragm."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array

_ZERO = 1e-9  # of the weight: below it the force beyond it is rounding


def momentum_imbalance(
    time: Array, *, force: Array, cg: Array, acceleration: Array, gravity: Array, mass: float,
    frequency: float, periods: int,
) -> float | None:  # fmt: skip
    """Return how far force and momentum of the liquid disagree, relative to the force.

    Newton's law asks F = m (g - a - c'') of the force F that the liquid exerts. Weighed with W and
    integrated by parts, with W and W' zero at both ends, it needs no derivative of c,

        int (F - m g) W dt = -m int a W dt - m int c W'' dt,

    and holds in a transient too. W = (1 - cos theta)^2 exp(-i omega t), theta from 0 to 2 pi over
    the last ``periods``. What a model leaves out of c'' shows here, and the error of the
    steps: the trapezoidal rule on their ends does not see a blow between them.

    Parameters
    ----------
    time
        Ends of steps (T,) [s].
    force
        Force that the liquid exerts (T, 3) [N].
    cg
        The liquid's CG in the tank frame (T, 3) [m].
    acceleration
        Acceleration of the tank (T, 3) [m/s^2].
    gravity
        Gravity (3,) [m/s^2].
    mass
        Mass of the liquid m [kg].
    frequency
        Frequency [Hz], omega/(2 pi).
    periods
        Number of the last whole periods that are weighed.

    Returns
    -------
    float or None
        Size of the difference over that of the left-hand side [-]; None without a period, or where
        the force is the weight alone.
    """
    if periods == 0 or len(time) == 0:
        return None
    omega, length = 2.0 * np.pi * frequency, periods / frequency
    chosen = time > time[-1] - length * (1.0 + 1e-9)
    t = time[chosen]
    theta, rate = 2.0 * np.pi * (1.0 - (t[-1] - t) / length), 2.0 * np.pi / length
    cosine, wave = np.cos(theta), np.exp(-1j * omega * t)
    window = (1.0 - cosine) ** 2
    first = 2.0 * rate * (1.0 - cosine) * np.sin(theta)
    second = 2.0 * rate**2 * (1.0 + cosine - 2.0 * cosine**2)
    curved = (second - 2j * omega * first - omega**2 * window) * wave
    weights = 0.5 * (np.diff(t, prepend=t[0]) + np.diff(t, append=t[-1]))  # trapezoidal rule
    pushed = (weights * window * wave) @ (force[chosen] - mass * gravity)
    moved = -mass * ((weights * window * wave) @ acceleration[chosen])
    moved -= mass * ((weights * curved) @ cg[chosen])
    size = float(np.linalg.norm(pushed))
    if size <= _ZERO * mass * float(np.linalg.norm(gravity)) * length:
        return None
    return float(np.linalg.norm(pushed - moved)) / size
