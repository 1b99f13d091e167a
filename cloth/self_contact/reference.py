"""Plain NumPy definitions of the compiled kernels that find contacts. Slow, and meant to be read.

Those of the planes that hold layers apart are in ``planes_reference``.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from cloth.arrays import Array, Bools, Ints
from cloth.self_contact.proximity import VERTEX


def near_boxes(lower: Array, upper: Array) -> Ints:
    """Return the pairs (k, 2) of boxes that overlap or touch, smaller index first, sorted."""
    apart = (lower[:, None] > upper[None]).any(axis=2)
    return np.argwhere(np.triu(~(apart | apart.T), 1))


def crossing_kernel(x: Array, triangles: Ints, pairs: Ints, least: float) -> Ints:
    """Return those ``pairs`` (k, 2) of triangles that share no node, one's edge piercing the other.

    A piercing is recognised by five volumes, each times six beyond ``least`` [m^3]: of the triangle
    with either end of the edge, opposite in sign, and of the edge with the three sides, alike in
    sign.
    """

    def volume(*nodes: int) -> float:
        p = x[list(nodes)]
        return float(np.linalg.det(p[1:] - p[0]))

    def pierces(s: Ints, t: Ints) -> bool:
        for p, q in ((s[0], s[1]), (s[1], s[2]), (s[2], s[0])):
            ends = np.array([volume(*t, p), volume(*t, q)])
            around = np.array([volume(p, q, t[i], t[(i + 1) % 3]) for i in range(3)])
            beyond = min(np.abs(ends).min(), np.abs(around).min()) > least
            if beyond and ends.prod() < 0.0 and abs(np.sign(around).sum()) == 3.0:
                return True
        return False

    found = [
        (a, b)
        for a, b in pairs.tolist()
        if not set(triangles[a]) & set(triangles[b])
        and (pierces(triangles[a], triangles[b]) or pierces(triangles[b], triangles[a]))
    ]
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def nearest(kind: int, p: Array) -> tuple[float, Array]:
    """Return the distance [m] of the pair ``p`` (4, 3) [m], and its nearest points' weights (4,).

    Bounded least squares; a triangle's nearest point lies inside, or else on one of its sides.
    Weights are base + s . moves with s in [0, 1].
    """
    if kind != VERTEX:
        ways = [([1.0, 0.0, -1.0, 0.0], [[-1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, -1.0]])]
    else:
        corner = -np.eye(4)[1:]
        inside = ([1.0, -1.0, 0.0, 0.0], [corner[1] - corner[0], corner[2] - corner[0]])
        sides = [(np.eye(4)[0] + corner[i], [corner[i - 2] - corner[i]]) for i in range(3)]
        ways = [inside, *sides]
    best, weights = np.inf, np.zeros(4)
    for base, moves in ways:
        steps = np.array(moves)
        found = lsq_linear((steps @ p).T, -(np.array(base) @ p), bounds=(0.0, 1.0), tol=1e-14)
        w = np.array(base) + found.x @ steps
        if kind == VERTEX and w[1:].max() > 0.0:
            continue  # beyond the triangle's third side
        distance = float(np.linalg.norm(w @ p))
        if distance < best:
            best, weights = distance, w
    return best, weights


def approaching_kernel(
    start: Array, end: Array, centres: Array, triangles: Ints, near: Ints, margin: float
) -> Ints:
    """Return those pairs ``near`` (k, 2) of triangles, no node in common, that may come near.

    Left out are those that a plane keeps ``margin`` [m] apart during the whole motion. It is
    normal to the line between ``centres`` (m, 3), of any length; the distance of two nodes along
    it is linear in time, so both ends of the motion decide.
    """
    found = []
    for s, t in near.tolist():
        axis = centres[s] - centres[t]
        gaps = [(x[triangles[s]] @ axis).min() - (x[triangles[t]] @ axis).max()
                for x in (start, end)]  # fmt: skip
        shared = set(triangles[s]) & set(triangles[t])
        if not shared and min(gaps) <= margin * np.linalg.norm(axis):
            found.append((s, t))
    return np.array(found, dtype=np.int64).reshape(-1, 2)


def approach(kind: int, p: Array, q: Array) -> float:
    """Return the most [m] by which a distance can shrink from ``p`` to ``q`` (4, 3) [m].

    The common motion of the four nodes is left out.
    """
    speed = np.linalg.norm(q - p - (q - p).mean(axis=0), axis=1)
    first = 1 if kind == VERTEX else 2
    return float(speed[:first].max() + speed[first:].max())


def candidate_kernel(
    start: Array, end: Array, pairs: Ints, margin: float, gaps: Array, kept: Bools
) -> None:
    """Fill in the distances ``gaps`` (k,) [m] of ``pairs`` (k, 5), and which pairs may come near.

    The distances are those at the start. ``kept`` (k,) becomes false where the distance less the
    most it can shrink is beyond ``margin`` [m], or where a plane normal to the nearest points'
    line, at the start or at the end, keeps the sides that far apart at both times, and so in
    between.
    """
    for k, (kind, *nodes) in enumerate(pairs.tolist()):
        first = 1 if kind == VERTEX else 2
        p, q = start[nodes], end[nodes]
        gaps[k], weights = nearest(kind, p)
        kept[k] = gaps[k] - approach(kind, p, q) <= margin
        for axis in (weights @ p, nearest(kind, q)[1] @ q):
            apart = [(x[:first] @ axis).min() - (x[first:] @ axis).max() for x in (p, q)]
            kept[k] &= min(apart) <= margin * np.linalg.norm(axis)


def meeting_distance(kind: int, p: Array, q: Array, samples: int) -> float:
    """Return the least distance [m] in the straight motion from ``p`` to ``q`` (4, 3) [m].

    At ``samples`` equal times, both ends included.
    """
    times = np.linspace(0.0, 1.0, samples)
    return min(nearest(kind, p + time * (q - p))[0] for time in times)
