"""Waves of a level surface in potentials of a ``RitzShape``'s kind."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


def slowest_wave(values: Array, weight: Array, inverse: Array) -> float:
    """Return omega^2/g [1/m] of the slowest wave of a level surface; 0 without a surface.

    1 over the largest of int phi^2 dS on the surface among potentials of int |grad phi|^2 dV = 1
    without a mean there (Rayleigh).

    Parameters
    ----------
    values
        Values of the harmonics but for the constant (N, k - 1) [-] at the surface's samples.
    weight
        Level areas of the samples (N,) [m^2].
    inverse
        As of ``RitzShape`` (k - 1, k - 1) [m^(-1/2)].
    """
    if not weight.any():
        return 0.0
    shown = values @ inverse
    shown -= weight @ shown / weight.sum()  # waves keep the volume
    return 1.0 / float(np.linalg.eigvalsh(shown.T @ (weight[:, None] * shown))[-1])
