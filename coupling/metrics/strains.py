"""How the sheet's tensile strain is spread over its area and over a run's time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from coupling.ports import Array

_EDGES = np.logspace(-7.0, 0.0, 351)  # 50 classes a decade: a quantile is right within 5 %


def spread(strain: Array, areas: Array) -> Array:
    """Return the area of the triangles in each class of strain.

    Parameters
    ----------
    strain
        Largest principal tensile strain of every triangle (m,) [-].
    areas
        Area of every triangle (m,) [m^2].

    Returns
    -------
    Array
        Area (351,) [m^2] by class, 50 classes a decade from 1e-7 to 1. The first class has what is
        compressed or hardly strained, the last one all beyond the last edge but one.
    """
    place = np.minimum(np.searchsorted(_EDGES, strain), len(_EDGES) - 1)
    return np.asarray(np.bincount(place, weights=areas, minlength=len(_EDGES)), dtype=np.float64)


def quantile(areas: Sequence[float], share: float) -> float:
    """Return the strain [-] that a ``share`` of the gathered ``areas`` (351,) stays below.

    Within 5 %, the width of a class; 0 in the first class, or without areas. ``areas`` by class as
    in ``spread``, of which only the ratios count.
    """
    gathered = np.cumsum(areas)
    if len(gathered) == 0:
        return 0.0
    place = int(np.searchsorted(gathered, share * gathered[-1]))
    return 0.0 if place == 0 else float(_EDGES[place])
