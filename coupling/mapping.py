"""Displacements from the diaphragm to the flow's points, forces back by the transpose.

Points map as x_flow = N x_cloth + c and forces as F_cloth = N^T F_flow, so that work is conserved
whatever N. N and c are those of a step: the coupling iterates on a fixed linear map.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

import numpy as np
from scipy.spatial import cKDTree

from coupling.ports import Array, StructureState

NEIGHBOURS_AT_LEAST = 12  # nodes a row may use; three conditions stand on every row
NEIGHBOURS_AT_MOST = 80
SUPPORT = 1.3  # radius of a row's support over the distance to the next targets


class InterfaceMap(Protocol):
    """What the coupling asks of a map."""

    def begin_step(self, state: StructureState, dt: float) -> Array | None:
        """Take the map of a step of ``dt`` [s] from ``state``; the shell's points (s, 3) [m]."""

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) of cloth nodes (n, 3)."""

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""

    def rows_to_cloth(self, rows: Array) -> Array:
        """Rows (r, n, 3) on cloth nodes of rows (r, p, 3) on flow points."""

    def beside(self, pressure: Array) -> Array:
        """Forces (n, 3) [N] of face pressures (F,) [Pa] on what of the sheet the patch is not."""

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are let be."""


class Matching:
    """The map of a structure whose nodes are the flow's points, in a shell that stays."""

    def begin_step(self, state: StructureState, dt: float) -> None:
        """Nothing moves from step to step."""

    def to_flow(self, nodes: Array) -> Array:
        """The nodes themselves (p, 3)."""
        return nodes

    def to_cloth(self, force: Array) -> Array:
        """The forces themselves (p, 3)."""
        return force

    def rows_to_cloth(self, rows: Array) -> Array:
        """The rows themselves (r, p, 3)."""
        return rows

    def beside(self, pressure: Array) -> Array:
        """Nothing: the patch is all of the sheet."""
        return np.zeros(3)

    def save(self) -> dict[str, Array]:
        """No memory."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """No memory."""


def moving_least_squares(source: Array, target: Array) -> Array:
    """Weights N (t, s) from values at ``source`` (s, 3) to ``target`` (t, 3), on a unit sphere.

    A row is the weighted least-norm set of weights that reproduces constants and what is linear
    in the tangent plane (Levin, Math. Comp. 67, 1998), over all sources within its support, so
    that those between two targets are averaged and receive their share by the transpose. The
    support reaches ``SUPPORT`` times as far as the third next target, and to
    ``NEIGHBOURS_AT_LEAST`` sources; a row is continuous in its target.
    """
    spacing = np.asarray(cKDTree(target).query(target, k=4)[0])[:, 3]
    count = min(NEIGHBOURS_AT_MOST, len(source))
    distance, near = (np.asarray(a) for a in cKDTree(source).query(target, k=count))
    least = distance[:, min(NEIGHBOURS_AT_LEAST, count) - 1]
    radius = np.maximum(SUPPORT * spacing, 1.01 * least)[:, None]
    share = np.clip(1.0 - distance / radius, 0.0, None)
    kernel = np.where(share > 0.0, share**2 + 1e-6, 0.0)
    aside = np.where(np.abs(target[:, 2:]) < 0.7, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    first = np.cross(target, aside)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(target, first)
    offset = (source[near] - target[:, None]) / radius[:, :, None]  # (t, k, 3)
    conditions = np.stack(
        [
            np.ones_like(distance),
            np.einsum("tkx,tx->tk", offset, first),
            np.einsum("tkx,tx->tk", offset, second),
        ],
        axis=2,
    )
    moments = np.einsum("tk,tka,tkb->tab", kernel, conditions, conditions)
    goal = np.broadcast_to(np.array([[1.0], [0.0], [0.0]]), (len(target), 3, 1))
    factor = np.linalg.solve(moments, goal)[..., 0]
    weights = np.zeros((len(target), len(source)))
    np.put_along_axis(weights, near, kernel * np.einsum("tka,ta->tk", conditions, factor), axis=1)
    return weights
