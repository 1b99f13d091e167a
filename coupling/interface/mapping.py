"""Displacements from the diaphragm to the flow's points, forces back by the transpose.

Points map as x_flow = N x_cloth + c and forces as F_cloth = N^T F_flow, so that work is conserved
whatever N. N and c are those of a step: the coupling iterates on a fixed linear map.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from cloth.compiled import compiled
from coupling.ports import Array, Ints, StructureState


@dataclass(frozen=True, kw_only=True)
class Support:
    """The sources that a row of weights may use.

    ``reach``: radius of the support over the distance to the third next target. ``least`` and
    ``most``: number of sources, whatever the radius; ``least`` is some times the conditions that
    stand on a row, three for means and six for quadratics, so that no row is ill-conditioned.
    """

    reach: float
    least: int
    most: int = 80


class StepMap(Protocol):
    """What maps cloth nodes to flow points in one step: fixed, and linear in the nodes."""

    @property
    def shell(self) -> Array | None:
        """The shell's points (s, 3) [m] at the step's end, None where they stay."""

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) [m] of cloth nodes (n, 3) [m]."""

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""

    def rows_to_cloth(self, rows: csr_array) -> Array:
        """Rows (r, n, 3) on cloth nodes of sparse rows (r, 3 p) on flow points."""


class InterfaceMap(Protocol):
    """What the coupling asks of a map: one for every step."""

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> StepMap:
        """The map of a step of ``dt`` [s] from ``state``.

        ``nodes`` (n, 3) [m]: where the structure's are expected at its end.
        """

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""


class Matching:
    """The map of a structure whose nodes are the flow's points, in a shell that stays."""

    shell: Array | None = None

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> Matching:
        """Return this map: it is the same in every step."""
        return self

    def to_flow(self, nodes: Array) -> Array:
        """Return the nodes themselves (p, 3) [m]."""
        return nodes

    def to_cloth(self, force: Array) -> Array:
        """Return the forces themselves (p, 3) [N]."""
        return force

    def rows_to_cloth(self, rows: csr_array) -> Array:
        """Return the rows themselves (r, p, 3), dense."""
        return rows.toarray().reshape(rows.shape[0], -1, 3)

    def save(self) -> dict[str, Array]:
        """Return no arrays: the map keeps no state."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Do nothing: the map keeps no state."""


def moving_least_squares(source: Array, target: Array, support: Support) -> Array:
    """Return weights N that average values at some points of the unit sphere to others.

    A row is the weighted least-norm set of weights that reproduces constants and what is linear
    in the tangent plane (Levin, Math. Comp. 67, 1998), over all sources within its support, so
    that those between two targets are averaged and receive their share by the transpose. The
    support reaches ``support.reach`` times as far as the third next target, and to
    ``support.least`` sources; a row is continuous in its target.

    Parameters
    ----------
    source, target
        Unit vectors to where values are known (s, 3) and wanted (t, 3); t is 4 at least.
    support
        Which sources a row may use.

    Returns
    -------
    Array
        Weights (t, s) [-], dense; each row sums to 1.
    """
    near, distance, radius = _supports(source, target, support)
    weights = np.zeros((len(target), len(source)))
    least_norm_weights(source, target, near, distance, radius, weights)
    return weights


def moving_quadratics(source: Array, target: Array, support: Support) -> Array:
    """Return weights as ``moving_least_squares`` does that reproduce quadratics too.

    Those are quadratics in the tangent plane. Means over a support of radius r flatten a wave of
    number k by k^2 r^2/20; these do so in the fourth power only. In return some weights are
    negative: for smooth surfaces.

    Parameters
    ----------
    source, target
        Unit vectors to where values are known (s, 3) and wanted (t, 3); t is 4 at least.
    support
        Which sources a row may use.

    Returns
    -------
    Array
        Weights (t, s) [-], dense; each row sums to 1.
    """
    near, distance, radius = _supports(source, target, support)
    share = np.maximum(1.0 - distance / radius[:, None], 0.0)
    kernel = np.where(share > 0.0, share**2 + 1e-6, 0.0)
    normal = target / np.linalg.norm(target, axis=1)[:, None]
    across = np.abs(normal[:, 2:]) < 0.7
    u = np.cross(normal, np.where(across, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))
    u /= np.linalg.norm(u, axis=1)[:, None]
    offset = (source[near] - target[:, None]) / radius[:, None, None]
    x, y = (np.einsum("tkd,td->tk", offset, axis) for axis in (u, np.cross(normal, u)))
    basis = np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2)
    gram = np.einsum("tk,tki,tkj->tij", kernel, basis, basis, optimize=True)
    wanted = np.zeros((len(target), 6, 1))
    wanted[:, 0] = 1.0
    factor = np.linalg.solve(gram, wanted)
    weights = np.zeros((len(target), len(source)))
    np.put_along_axis(weights, near, kernel * (basis @ factor)[:, :, 0], axis=1)
    return weights


def _supports(source: Array, target: Array, support: Support) -> tuple[Ints, Array, Array]:
    """Nearest sources (t, k), their distances (t, k), and the radius (t,) of each row's support."""
    spacing = np.asarray(cKDTree(target).query(target, k=4)[0])[:, 3]
    count = min(support.most, len(source))
    distance, near = (np.asarray(a) for a in cKDTree(source).query(target, k=count))
    return (
        near,
        distance,
        np.maximum(support.reach * spacing, 1.01 * distance[:, min(support.least, count) - 1]),
    )


@compiled
def least_norm_weights(
    source: Array, target: Array, near: Ints, distance: Array, radius: Array, weights: Array
) -> None:
    """Fill the weights of least norm that reproduce constants and linear fields.

    They are kernel * (1, x, y) f with the offset's tangential parts x and y over the support's
    radius, where f solves sum kernel (1, x, y)^T (1, x, y) f = (1, 0, 0).

    Parameters
    ----------
    source, target
        Points on the unit sphere that values are known at (s, 3) and wanted at (t, 3).
    near, distance
        Sources of every target's row (t, k), and how far they are (t, k).
    radius
        Radius of every row's support (t,).
    weights
        Weights (t, s) [-], filled here; 0 before.
    """
    across = np.empty((near.shape[1], 3))  # kernel, x and y of every source
    for t in range(target.shape[0]):
        t0, t1, t2 = target[t]
        if abs(t2) < 0.7:  # target x z, or target x x
            u0, u1, u2 = t1, -t0, 0.0
        else:
            u0, u1, u2 = 0.0, t2, -t1
        size = math.sqrt(u0 * u0 + u1 * u1 + u2 * u2)
        u0, u1, u2 = u0 / size, u1 / size, u2 / size
        v0, v1, v2 = t1 * u2 - t2 * u1, t2 * u0 - t0 * u2, t0 * u1 - t1 * u0
        a, b, c, d, e, f = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0  # [[a, b, c], [b, d, e], [c, e, f]]
        for k in range(near.shape[1]):
            share = 1.0 - distance[t, k] / radius[t]
            w = share * share + 1e-6 if share > 0.0 else 0.0
            o0 = (source[near[t, k], 0] - t0) / radius[t]
            o1 = (source[near[t, k], 1] - t1) / radius[t]
            o2 = (source[near[t, k], 2] - t2) / radius[t]
            x, y = o0 * u0 + o1 * u1 + o2 * u2, o0 * v0 + o1 * v1 + o2 * v2
            across[k, 0], across[k, 1], across[k, 2] = w, x, y
            a, b, c = a + w, b + w * x, c + w * y
            d, e, f = d + w * x * x, e + w * x * y, f + w * y * y
        p, q, r = d * f - e * e, c * e - b * f, b * e - c * d  # cofactors of the first column
        scale = 1.0 / (a * p + b * q + c * r)
        for k in range(near.shape[1]):
            w, x, y = across[k]
            weights[t, near[t, k]] = scale * w * (p + x * q + y * r)
