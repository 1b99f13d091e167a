"""Displacements from the diaphragm to the flow's points, forces back by the transpose.

Points map as x_flow = N x_cloth and forces as F_cloth = N^T F_flow, so that work is conserved
whatever N; the rows of N sum to one, which conserves force, and reproduce the moulded shape, which
with x_flow = N x_cloth conserves the moment: all to rounding.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from coupling.ports import Array, Ints

NEIGHBOURS_AT_LEAST = 12  # nodes a row may use; four conditions stand on every row
RIM_NEIGHBOURS = 4
SUPPORT = 1.3  # radius of a row's support over the distance to the flow's next points


class MovingLeastSquares:
    """Linear map N (p, n) from cloth nodes to flow points, frozen for the run.

    ``source`` (n, 3) and ``target`` (p, 3) [m] are both in the moulded shape; ``source_rim`` and
    ``target_rim`` mark the clamped rims, which see only each other. A row is the weighted least-
    norm set of weights that reproduces constants and the three coordinates (Levin, Math. Comp. 67,
    1998), over all nodes within its support, so that the cloth between two flow points is averaged
    and receives its share of the force.
    """

    def __init__(
        self,
        source: Array,
        target: Array,
        *,
        source_rim: NDArray[np.bool_],
        target_rim: NDArray[np.bool_],
    ) -> None:
        self.weights = np.zeros((len(target), len(source)))
        spacing = np.asarray(cKDTree(target).query(target, k=4)[0])[:, 3]
        tree = cKDTree(source)
        for row in np.flatnonzero(~target_rim).tolist():
            radius = SUPPORT * spacing[row]
            near = np.asarray(tree.query_ball_point(target[row], radius))
            if len(near) < NEIGHBOURS_AT_LEAST:
                near, farthest = _nearest(tree, target[row], NEIGHBOURS_AT_LEAST)
                radius = 1.01 * farthest
            self._fill(row, np.sort(near), source, target[row], radius)
        rim = np.flatnonzero(source_rim)
        rim_tree = cKDTree(source[rim])
        for row in np.flatnonzero(target_rim).tolist():
            near, farthest = _nearest(rim_tree, target[row], RIM_NEIGHBOURS)
            self._fill(row, np.sort(rim[near]), source, target[row], 1.5 * farthest)

    def _fill(self, row: int, near: Ints, source: Array, target: Array, radius: float) -> None:
        offset = (source[near] - target) / radius
        share = np.clip(1 - np.linalg.norm(offset, axis=1), 0, None)
        kernel = share**2 + 1e-6
        conditions = np.vstack([np.ones(len(near)), offset.T])  # (4, k)
        scaled = conditions * np.sqrt(kernel)
        goal = np.array([1.0, 0.0, 0.0, 0.0])
        self.weights[row, near] = np.sqrt(kernel) * (np.linalg.pinv(scaled, rcond=1e-10) @ goal)

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) of cloth nodes (n, 3)."""
        return self.weights @ nodes

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""
        return self.weights.T @ force

    def rows_to_cloth(self, rows: Array) -> Array:
        """Rows (r, n, 3) on cloth nodes of rows (r, p, 3) on flow points."""
        return np.ascontiguousarray(np.matmul(self.weights.T, rows))


def _nearest(tree: cKDTree, point: Array, count: int) -> tuple[Ints, float]:
    """The ``count`` nodes next to ``point`` (3,), and the distance [m] of the farthest of them."""
    distance, near = tree.query(point, k=count)
    return np.asarray(near), float(np.asarray(distance)[-1])


class Matching:
    """The map of a structure whose nodes are the flow's points."""

    def to_flow(self, nodes: Array) -> Array:
        """The nodes themselves (p, 3)."""
        return nodes

    def to_cloth(self, force: Array) -> Array:
        """The forces themselves (p, 3)."""
        return force

    def rows_to_cloth(self, rows: Array) -> Array:
        """The rows themselves (r, p, 3)."""
        return rows
