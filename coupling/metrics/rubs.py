"""Where and how far the rubber has rubbed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.metrics.bernoulli import node_areas
from coupling.ports import Array, Ints

LEAST = 1e-6  # m: a sheet that rests creeps by the solver's residual, not by rubbing


@dataclass(frozen=True, kw_only=True)
class Rub:
    """Slip of the whole diaphragm: ``largest`` and ``mean`` [m], and where the largest is.

    ``place`` [degrees]: polar angle from the moulded pole, azimuth in [0, 360) from x to y.
    """

    largest: float
    mean: float
    place: tuple[float, float]


def rub(slip: Array, reference: Array, triangles: Ints) -> Rub | None:
    """Largest and mean of the nodes' ``slip`` (n,) [m]; None where none is above a micrometre.

    ``reference`` (n, 3) [m], the moulded hemisphere about the origin, its pole on the z axis;
    ``triangles`` (m, 3). In the mean a node counts with a third of its triangles' moulded area:
    exact for a slip that is linear in each triangle. Of equal largest slips the first is taken.
    The wear itself, which also grows with the contact's pressure, is not computed.
    """
    node = int(np.argmax(slip))
    largest = float(slip[node])
    if not largest > LEAST:
        return None
    area = node_areas(reference[None], triangles)[0]
    polar, azimuth = mould_angles(reference[node])
    # rounded first: -1e-15 modulo 360 is 360
    turned = round(float(np.degrees(azimuth)), 9) % 360.0
    return Rub(
        largest=largest,
        mean=float(slip @ area / area.sum()),
        place=(float(np.degrees(polar)), turned),
    )


def mould_angles(reference: Array) -> tuple[Array, Array]:
    """Polar angle from the pole and azimuth from x, each (...) [rad], of ``reference`` (..., 3).

    The pole is that of the half space, upper or lower, in which the points lie.
    """
    x, y, z = np.moveaxis(reference, -1, 0)
    return np.arctan2(np.hypot(x, y), np.abs(z)), np.arctan2(y, x)
