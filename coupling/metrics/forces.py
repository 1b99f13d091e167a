"""Forces of the liquid on tank and diaphragm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def momentum_imbalance(
    *, force: Complex, cg: Complex, displacement: Complex, mass: float, frequency: float
) -> float | None:
    """Return how far force and momentum of the liquid disagree, relative to the force.

    Newton's law asks force = m omega^2 (displacement + cg) for the force that the liquid exerts. A
    model that leaves out c'' shows it here.

    Parameters
    ----------
    force
        Complex first harmonic of the force that the liquid exerts (3,) [N].
    cg
        Complex first harmonic of the liquid's CG in the tank frame (3,) [m].
    displacement
        Complex first harmonic of the tank's displacement (3,) [m].
    mass
        Mass of the liquid m [kg].
    frequency
        Frequency [Hz], omega/(2 pi).

    Returns
    -------
    float or None
        The relative difference [-]; None without a force.
    """
    size = float(np.linalg.norm(force))
    if size == 0.0:
        return None
    expected = mass * (2.0 * np.pi * frequency) ** 2 * (displacement + cg)
    return float(np.linalg.norm(force - expected)) / size
