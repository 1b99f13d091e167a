"""How far the flow's boundary lies off the diaphragm that it stands for."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from cloth.compiled import compiled
from cloth.self_contact.proximity import VERTEX, nearest
from coupling.ports import Array, Ints

_CANDIDATES = 24  # triangles with the nearest centroids that are looked at


@compiled
def _nearest(points: Array, nodes: Array, triangles: Ints, near: Ints) -> tuple[Array, Ints, Array]:
    """Distance (p,), triangle (p,) and its corners' shares (p, 3) of each point among its ``near``.

    ``near`` (p, k): the triangles that are looked at.
    """
    found, chosen = np.full(len(points), np.inf), np.zeros(len(points), dtype=np.int64)
    shares = np.zeros((len(points), 3))
    corners, weights, way = np.empty((4, 3)), np.empty(4), np.empty(3)
    for i in range(len(points)):
        corners[0] = points[i]
        for t in near[i]:
            for k in range(3):
                corners[k + 1] = nodes[triangles[t, k]]
            distance = nearest(VERTEX, corners, weights, way)
            if distance < found[i]:
                found[i], chosen[i] = distance, t
                for k in range(3):
                    shares[i, k] = -weights[k + 1]
    return found, chosen, shares


def nearest_on_sheet(points: Array, nodes: Array, triangles: Ints) -> tuple[Array, Ints, Array]:
    """Return where on a sheet points have their nearest points.

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
    distance : Array
        Distances (p,) [m]. Only the 24 triangles with the nearest centroids are looked at, so that
        a distance can come out too large beside triangles of very unequal size.
    triangle : Ints
        The triangle (p,) of each nearest point.
    shares : Array
        The nearest points' barycentric coordinates (p, 3) in it.
    """
    centres = nodes[triangles].mean(axis=1)
    near = cKDTree(centres).query(points, k=min(_CANDIDATES, len(triangles)))[1]
    return _nearest(points, nodes, triangles, near.reshape(len(points), -1).astype(triangles.dtype))


def distance_to_sheet(points: Array, nodes: Array, triangles: Ints) -> Array:
    """Return the distance (p,) [m] of points to a sheet, as ``nearest_on_sheet`` has it."""
    return nearest_on_sheet(points, nodes, triangles)[0]
