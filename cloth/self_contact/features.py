"""Nodes, edges and triangles of a sheet that face each other."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Ints
from cloth.self_contact.proximity import EDGES, VERTEX


class Features:
    """Edges (e, 2) of ``triangles`` (m, 3), and the pairs of primitives of pairs of triangles."""

    def __init__(self, triangles: Ints) -> None:
        sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        edges, inverse = np.unique(sides, axis=0, return_inverse=True)
        self.triangles, self.edges = triangles, np.asarray(edges)
        self._sides = np.asarray(inverse).reshape(-1, 3)

    def pairs(self, facing: Ints) -> Ints:
        """Return the pairs of primitives (k, 5), each once, of triangles ``facing`` (j, 2).

        Kind and four nodes: six times a node and a triangle, nine times an edge and an edge.
        """
        if len(facing) == 0:
            return np.empty((0, 5), dtype=np.int64)
        m, e = len(self.triangles), len(self.edges)
        source, target = np.concatenate([facing, facing[:, ::-1]]).T
        key = np.unique(self.triangles[source] * m + target[:, None])
        first, second = self._sides[facing[:, 0]], self._sides[facing[:, 1]]
        low = np.minimum(first[:, :, None], second[:, None, :])
        high = np.maximum(first[:, :, None], second[:, None, :])
        edge_key = np.unique(low * e + high)
        nodes = np.column_stack([np.full(len(key), VERTEX), key // m, self.triangles[key % m]])
        edges = np.column_stack(
            [np.full(len(edge_key), EDGES), self.edges[edge_key // e], self.edges[edge_key % e]]
        )
        return np.asarray(np.concatenate([nodes, edges]))
