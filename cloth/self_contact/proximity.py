"""Distance of a node to a triangle, of an edge to an edge, and the time they meet.

Both kinds are a pair of four nodes: ``kind`` VERTEX is a node and a triangle (1 + 3 nodes),
EDGES two edges (2 + 2 nodes). The nearest points differ by sum_i w_i p_i, with signed weights w
(4,): positive and of sum 1 on the first side, negative and of sum -1 on the second.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.compiled import compiled

VERTEX, EDGES = 0, 1
FLAT = 1e-12  # squared sine below which a triangle has no inside, or two edges are parallel
STEP = 0.9  # share of the safe time taken at once
STEPS_MAX = 200


@compiled
def _dot(p: Array, i: int, j: int, k: int, m: int) -> float:
    """(p_j - p_i) . (p_m - p_k)."""
    total = 0.0
    for d in range(3):
        total += (p[j, d] - p[i, d]) * (p[m, d] - p[k, d])
    return total


@compiled
def difference(p: Array, w: Array, out: Array) -> float:
    """Put sum_i w_i p_i into ``out``, and return its length [m].

    Parameters
    ----------
    p
        Positions of a pair's four nodes (4, 3) [m].
    w
        Signed weights (4,).
    out
        Becomes the sum (3,) [m].
    """
    for d in range(3):
        out[d] = w[0] * p[0, d] + w[1] * p[1, d] + w[2] * p[2, d] + w[3] * p[3, d]
    return math.sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2])


@compiled
def _side(p: Array, i: int, j: int, w: Array, best: float, out: Array) -> float:
    """Replace ``w`` by the point of the side from i to j nearest to node 0 if within ``best``."""
    square = _dot(p, i, j, i, j)
    s = 0.0
    if square > 0.0:
        s = min(1.0, max(0.0, _dot(p, i, j, i, 0) / square))
    total = 0.0
    for d in range(3):
        out[d] = p[0, d] - p[i, d] - s * (p[j, d] - p[i, d])
        total += out[d] * out[d]
    if total < best:
        w[0], w[1], w[2], w[3] = 1.0, 0.0, 0.0, 0.0
        w[i] = s - 1.0
        w[j] = -s
        return total
    return best


@compiled
def _vertex_weights(p: Array, w: Array, out: Array) -> None:
    """Nearest point of the triangle (1, 2, 3) to node 0: its inside, or else the best side."""
    aa, ab, bb = _dot(p, 1, 2, 1, 2), _dot(p, 1, 2, 1, 3), _dot(p, 1, 3, 1, 3)
    square = aa * bb - ab * ab
    if square > FLAT * aa * bb:
        a, b = _dot(p, 1, 2, 1, 0), _dot(p, 1, 3, 1, 0)
        u, v = (bb * a - ab * b) / square, (aa * b - ab * a) / square
        if u >= 0.0 and v >= 0.0 and u + v <= 1.0:
            w[0], w[1], w[2], w[3] = 1.0, u + v - 1.0, -u, -v
            return
    best = _side(p, 1, 2, w, np.inf, out)
    best = _side(p, 2, 3, w, best, out)
    _side(p, 3, 1, w, best, out)


@compiled
def _edge_weights(p: Array, w: Array) -> None:
    """Nearest points of the segments (0, 1) and (2, 3) (Ericson 2005, 5.1.9)."""
    a, e, f = _dot(p, 0, 1, 0, 1), _dot(p, 2, 3, 2, 3), _dot(p, 2, 3, 2, 0)
    b, c = _dot(p, 0, 1, 2, 3), _dot(p, 0, 1, 2, 0)
    s, t = 0.0, 0.0
    square = a * e - b * b
    if square > FLAT * a * e:
        s = min(1.0, max(0.0, (b * f - c * e) / square))
    if e > 0.0:
        t = (b * s + f) / e
    if (t < 0.0 or t > 1.0 or e <= 0.0) and a > 0.0:
        t = min(1.0, max(0.0, t))
        s = min(1.0, max(0.0, (b * t - c) / a))
    w[0], w[1], w[2], w[3] = 1.0 - s, s, t - 1.0, -t


@compiled
def nearest(kind: int, p: Array, w: Array, out: Array) -> float:
    """Return the distance [m] of a pair, and fill the weights and difference of its nearest points.

    Any length may be zero. Edges with a squared sine below 1e-12 count as parallel, and triangles
    that thin as their sides: the distance is then too large by 1e-6 of their length at most.

    Parameters
    ----------
    kind
        VERTEX or EDGES.
    p
        Positions of the four nodes (4, 3) [m].
    w
        Becomes the nearest points' signed weights (4,).
    out
        Becomes the vector from the second side's nearest point to the first side's (3,) [m].
    """
    if kind == VERTEX:
        _vertex_weights(p, w, out)
    else:
        _edge_weights(p, w)
    return difference(p, w, out)


@compiled
def approach(kind: int, p: Array, q: Array) -> float:
    """Return the most by which a pair's distance can shrink [m], less the common motion.

    Parameters
    ----------
    kind
        VERTEX or EDGES.
    p, q
        Positions of the four nodes (4, 3) [m] at the start and at the end of a motion.
    """
    size = np.empty(4)
    mean = np.zeros(3)
    for d in range(3):
        for i in range(4):
            mean[d] += 0.25 * (q[i, d] - p[i, d])
    for i in range(4):
        square = 0.0
        for d in range(3):
            square += (q[i, d] - p[i, d] - mean[d]) ** 2
        size[i] = math.sqrt(square)
    if kind == VERTEX:
        return float(size[0] + max(size[1], max(size[2], size[3])))
    return float(max(size[0], size[1]) + max(size[2], size[3]))


@compiled
def meeting(
    kind: int, p: Array, q: Array, stop: float, w: Array, here: Array, out: Array
) -> tuple[float, float]:
    """Return when a pair in straight motion first comes as near as a given distance.

    Additive conservative advancement (Li et al. 2021, section 5.1), which
    needs no root of a cubic and works for degenerate pairs. A motion that crawls along
    for 200 steps near ``stop`` counts as met.

    Parameters
    ----------
    kind
        VERTEX or EDGES.
    p, q
        Positions of the four nodes (4, 3) [m] at the start and at the end of the motion.
    stop
        The distance that is looked for [m].
    w, here, out
        Become weights (4,), positions (4, 3) [m] and difference (3,) [m] at the time found, the
        first and the last as in ``nearest``.

    Returns
    -------
    time : float
        First time in [0, 1] at which the distance is at most ``stop``, or 1 if there is none;
        always before the pair touches.
    distance : float
        Distance then [m].
    """
    for i in range(4):
        for d in range(3):
            here[i, d] = p[i, d]
    distance, speed, time = nearest(kind, p, w, out), approach(kind, p, q), 0.0
    for _ in range(STEPS_MAX):
        if distance <= stop or time >= 1.0:
            return time, distance
        if STEP * distance >= speed * (1.0 - time):
            time = 1.0
        else:
            time += STEP * distance / speed
        for i in range(4):
            for d in range(3):
                here[i, d] = p[i, d] + time * (q[i, d] - p[i, d])
        distance = nearest(kind, here, w, out)
    return min(time, 0.999), distance
