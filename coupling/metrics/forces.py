"""Forces of the liquid on tank and diaphragm."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Complex = NDArray[np.complex128]


def momentum_imbalance(
    *, force: Complex, cg: Complex, displacement: Complex, mass: float, frequency: float
) -> float | None:
    """How far force and momentum of the liquid disagree, relative to the force.

    ``force`` [N], ``cg``, ``displacement`` [m]: complex first harmonics (3,); ``mass`` [kg] of the
    liquid. Newton's law asks force = m omega^2 (displacement + cg) for the force that the liquid
    exerts. A model that leaves out c'' shows it here. None without a force.
    """
    size = float(np.linalg.norm(force))
    if size == 0.0:
        return None
    expected = mass * (2.0 * np.pi * frequency) ** 2 * (displacement + cg)
    return float(np.linalg.norm(force - expected)) / size
