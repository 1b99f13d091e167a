"""Maps of what a scan differs by, over the nodes of the diaphragm."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array
from coupling.scans.sheet import Sheet
from coupling.scans.statistics import Measured

_LEAST = 0.5  # points, by their shares, without which a node has no value


def node_means(sheet: Sheet, measured: Measured) -> dict[str, Array]:
    """Return mean differences of the points around each node (n,), NaN where there are none.

    ``points``: how many, each shared among the corners of the triangle nearest to it; ``vertical``
    and ``normal`` [m]: vertical difference and signed nearest distance, positive above the run's
    and towards the gas.
    """
    triangle, shares = measured.matches.triangle, measured.matches.shares
    nodes, heights = sheet.triangles[triangle], measured.heights.difference
    found = {}
    for name, values, used in (
        ("vertical", heights, measured.upright),
        ("normal", measured.matches.distance, measured.inside),
    ):
        weight, total = (
            np.bincount(nodes[used].ravel(), what.ravel(), minlength=len(sheet.nodes))
            for what in (shares[used], shares[used] * values[used, None])
        )
        found[name] = np.where(weight >= _LEAST, total / np.maximum(weight, _LEAST), np.nan)
    inside = measured.inside
    number = np.bincount(nodes[inside].ravel(), shares[inside].ravel(), minlength=len(sheet.nodes))
    return {"points": number, **found}
