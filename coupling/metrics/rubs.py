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
    """Return the largest and the mean slip of the nodes, and where the largest is.

    Parameters
    ----------
    slip
        Distance that each node has slid (n,) [m].
    reference
        Nodes of the moulded hemisphere about the origin (n, 3) [m], its pole on the z axis.
    triangles
        Nodes of each triangle (m, 3).

    Returns
    -------
    Rub or None
        Slips [m] and a place [degrees]; None where no slip is above a micrometre.

    Notes
    -----
    In the mean a node counts with a third of its triangles' moulded area: exact for a slip that is
    linear in each triangle. Of equal largest slips the first is taken. The wear itself, which also
    grows with the contact's pressure, is not computed.
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
    """Return the polar angle from the pole and the azimuth from x, each (...) [rad].

    ``reference`` (..., 3) [m]: moulded points. The pole is that of the half space, upper or lower,
    in which they lie.
    """
    x, y, z = np.moveaxis(reference, -1, 0)
    return np.arctan2(np.hypot(x, y), np.abs(z)), np.arctan2(y, x)
