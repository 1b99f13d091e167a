"""Where the liquid lies: its level in a ball, its centre of gravity below the diaphragm."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints


def level_of_fill_fraction(fill_fraction: float) -> float:
    """Depth h/R of a sphere filled to ``fill_fraction``: the root of h^2 (3 - h) = 4 FF in [0, 2].

    The cap's volume is pi h^2 (3 - h) R^3/3; the cubic is solved exactly by Viete's cosine.
    ``ValueError`` outside [0, 1].
    """
    if not 0.0 <= fill_fraction <= 1.0:
        raise ValueError(f"fill fraction: must lie in [0, 1], got {fill_fraction:g}.")
    angle = (np.arccos(1.0 - 2.0 * fill_fraction) + 4.0 * np.pi) / 3.0
    return float(np.clip(1.0 + 2.0 * np.cos(angle), 0.0, 2.0))


def fill_fraction_of_level(level: float) -> float:
    """Inverse of ``level_of_fill_fraction``: h^2 (3 - h)/4 for h = ``level`` in radii."""
    return level**2 * (3.0 - level) / 4.0


def liquid_cg(position: Array, triangles: Ints, radius: float, volume: float) -> Array:
    """Centre of gravity (3,) [m] of the liquid below the diaphragm at ``position`` (n, 3) [m].

    The lower half ball of ``radius`` [m] and the cone from the diaphragm to the tank's centre, of
    ``volume`` [m^3] together. Exact for the triangles.
    """
    a, b, c = (position[triangles[:, k]] for k in range(3))
    cone = np.einsum("mx,mx->m", a, np.cross(b, c)) / 6.0
    moment = cone @ (a + b + c) / 4.0
    moment[2] -= np.pi * radius**4 / 4.0
    return np.asarray(moment / volume)
