"""How far the flow's boundary lies off the diaphragm that it stands for."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from cloth.compiled import compiled
from cloth.self_contact.proximity import VERTEX, nearest
from coupling.ports import Array, Ints

_CANDIDATES = 24  # triangles with the nearest centroids that are looked at


@compiled
def _least(points: Array, nodes: Array, triangles: Ints, near: Ints) -> Array:
    """Distance (p,) of each point to the nearest of its own ``near`` (p, k) triangles."""
    found = np.full(len(points), np.inf)
    corners, weights, way = np.empty((4, 3)), np.empty(4), np.empty(3)
    for i in range(len(points)):
        corners[0] = points[i]
        for t in near[i]:
            for k in range(3):
                corners[k + 1] = nodes[triangles[t, k]]
            found[i] = min(found[i], nearest(VERTEX, corners, weights, way))
    return found


def distance_to_sheet(points: Array, nodes: Array, triangles: Ints) -> Array:
    """Return the distance of points to a sheet.

    Parameters
    ----------
    points
        Points (p, 3) [m].
    nodes
        Nodes of the sheet (n, 3) [m].
    triangles
        Nodes of each of its triangles (m, 3).

    Returns
    -------
    Array
        Distances (p,) [m]. Only the 24 triangles with the nearest centroids are looked at, so that
        a distance can come out too large beside triangles of very unequal size.
    """
    centres = nodes[triangles].mean(axis=1)
    near = cKDTree(centres).query(points, k=min(_CANDIDATES, len(triangles)))[1]
    return _least(points, nodes, triangles, near.reshape(len(points), -1).astype(triangles.dtype))
