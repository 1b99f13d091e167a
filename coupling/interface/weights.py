"""Weights between values at points of the unit sphere, by moving least squares."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from cloth.compiled import compiled
from coupling.ports import Array, Ints

SPARE = 8  # sources beyond a support's least that are looked for first


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


class Sources:
    """Unit vectors ``points`` (s, 3) to where values are known, in a search tree."""

    def __init__(self, points: Array) -> None:
        self.points = points
        self._tree = cKDTree(points)

    def beside(self, target: Array, *supports: Support) -> Neighbours:
        """Return which of them the rows of weights of these ``supports`` may use.

        ``target`` (t, 3): unit vectors to where values are wanted; t is 4 at least.
        """
        spacing = np.asarray(cKDTree(target).query(target, k=4)[0])[:, 3]
        most = min(max(support.most for support in supports), len(self.points))
        count = min(most, max(support.least for support in supports) + SPARE)
        while True:
            distance, near = (np.asarray(a) for a in self._tree.query(target, k=count))
            found = Neighbours(
                source=self.points, target=target, near=near, distance=distance, spacing=spacing
            )
            reached = max(float((found.radius(s) - distance[:, -1]).max()) for s in supports)
            if reached <= 0.0 or count == most:
                return found
            count = min(most, 2 * count)


@dataclass(frozen=True, kw_only=True)
class Neighbours:
    """Sources beside targets, the nearest first.

    ``source`` (s, 3), ``target`` (t, 3): unit vectors; ``near`` (t, k): the sources of each row, at
    ``distance`` (t, k) from its target; ``spacing`` (t,): from a target to the third next.
    """

    source: Array
    target: Array
    near: Ints
    distance: Array
    spacing: Array

    def radius(self, support: Support) -> Array:
        """Return the radius (t,) of each row's ``support``."""
        last = min(support.least, self.near.shape[1]) - 1
        return np.maximum(support.reach * self.spacing, 1.01 * self.distance[:, last])


def moving_least_squares(beside: Neighbours, support: Support) -> Array:
    """Return weights N that average values at some points of the unit sphere to others.

    A row is the weighted least-norm set of weights that reproduces constants and what is linear
    in the tangent plane (Levin, Math. Comp. 67, 1998), over all sources within its support, so
    that those between two targets are averaged and receive their share by the transpose. The
    support reaches ``support.reach`` times as far as the third next target, and to
    ``support.least`` sources; a row is continuous in its target.

    Parameters
    ----------
    beside
        The sources beside the targets, found for this support among others.
    support
        Which of them a row may use.

    Returns
    -------
    Array
        Weights (t, s) [-], dense; each row sums to 1.
    """
    weights = np.zeros((len(beside.target), len(beside.source)))
    least_norm_weights(
        beside.source, beside.target, beside.near, beside.distance, beside.radius(support), weights
    )
    return weights


def moving_quadratics(beside: Neighbours, support: Support) -> Array:
    """Return weights as ``moving_least_squares`` does that reproduce quadratics too.

    Those are quadratics in the tangent plane. Means over a support of radius r flatten a wave of
    number k by k^2 r^2/20; these do so in the fourth power only. In return some weights are
    negative: for smooth surfaces.

    Parameters
    ----------
    beside
        The sources beside the targets, found for this support among others.
    support
        Which of them a row may use.

    Returns
    -------
    Array
        Weights (t, s) [-], dense; each row sums to 1.
    """
    source, target, near, radius = (
        beside.source, beside.target, beside.near, beside.radius(support),
    )  # fmt: skip
    share = np.maximum(1.0 - beside.distance / radius[:, None], 0.0)
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
