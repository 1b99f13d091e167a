"""Which triangles of a sheet pass through each other."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.self_contact.broad_phase import motion_boxes, near_boxes

PIERCING = 1e-12  # least volume of the five tetrahedra of a piercing, over the box's extent cubed


@compiled
def _volume(x: Array, a: int, b: int, c: int, d: int) -> float:
    """Six times the signed volume of a tetrahedron, from differences to its first node."""
    p0, p1, p2 = x[b, 0] - x[a, 0], x[b, 1] - x[a, 1], x[b, 2] - x[a, 2]
    q0, q1, q2 = x[c, 0] - x[a, 0], x[c, 1] - x[a, 1], x[c, 2] - x[a, 2]
    r0, r1, r2 = x[d, 0] - x[a, 0], x[d, 1] - x[a, 1], x[d, 2] - x[a, 2]
    return float(p0 * (q1 * r2 - q2 * r1) + p1 * (q2 * r0 - q0 * r2) + p2 * (q0 * r1 - q1 * r0))


@compiled
def _inside(x: Array, p: int, q: int, a: int, b: int, c: int, least: float) -> bool:
    """Whether the line from p to q passes the triangle's inside, by more than ``least``."""
    first = _volume(x, p, q, a, b)
    if abs(first) <= least:
        return False
    second = _volume(x, p, q, b, c)
    third = _volume(x, p, q, c, a)
    if first > 0.0:
        return second > least and third > least
    return second < -least and third < -least


@compiled
def _apart(first: float, second: float, least: float) -> bool:
    return (first > least and second < -least) or (first < -least and second > least)


@compiled
def _pierces(x: Array, triangles: Ints, source: int, target: int, least: float) -> bool:
    """Whether an edge of the triangle ``source`` passes through the triangle ``target``."""
    p, q, r = triangles[source, 0], triangles[source, 1], triangles[source, 2]
    a, b, c = triangles[target, 0], triangles[target, 1], triangles[target, 2]
    u, v, w = _volume(x, a, b, c, p), _volume(x, a, b, c, q), _volume(x, a, b, c, r)
    if _apart(u, v, least) and _inside(x, p, q, a, b, c, least):
        return True
    if _apart(v, w, least) and _inside(x, q, r, a, b, c, least):
        return True
    return _apart(w, u, least) and _inside(x, r, p, a, b, c, least)


@compiled
def share_node(triangles: Ints, s: int, t: int) -> bool:
    """Return whether the triangles ``s`` and ``t`` have a node in common."""
    a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
    for i in range(3):
        node = triangles[s, i]
        if node in (a, b, c):
            return True
    return False


@compiled
def crossing_kernel(x: Array, triangles: Ints, pairs: Ints, least: float) -> Ints:
    """See ``cloth.self_contact.reference.crossing_kernel``."""
    found, count = np.empty_like(pairs), 0
    for k in range(pairs.shape[0]):
        s, t = pairs[k, 0], pairs[k, 1]
        if share_node(triangles, s, t):
            continue
        if _pierces(x, triangles, s, t, least) or _pierces(x, triangles, t, s, least):
            found[count, 0], found[count, 1] = s, t
            count += 1
    return found[:count].copy()


def crossings_among(position: Array, triangles: Ints, pairs: Ints) -> Ints:
    """Return those pairs of triangles that cross, by the rules of ``crossing_pairs``.

    Parameters
    ----------
    position
        Positions (n, 3) [m]; that they are finite is not checked.
    triangles
        Nodes of each triangle (m, 3).
    pairs
        Pairs (k, 2) of triangles to look at; those with a common node do not cross.

    Returns
    -------
    Ints
        The pairs (j, 2) that cross, the smaller index first, sorted.
    """
    if len(pairs) == 0:
        return pairs
    lower, upper = motion_boxes(position, position, triangles, 0.0)
    extent = float((upper - lower).max(initial=0.0))
    found = crossing_kernel(position, triangles, pairs, PIERCING * extent**3)
    found.sort(axis=1)
    return np.asarray(found[np.lexsort((found[:, 1], found[:, 0]))])


def crossing_pairs(position: Array, triangles: Ints) -> Ints:
    """Return the pairs of triangles that share no node and cross.

    Two triangles cross when an edge of one pierces
    the other (Guigue and Devillers 2003, by signs of tetrahedra's volumes). Each of the five
    volumes must exceed 1e-12 of L^3, L the longest extent of a triangle's box: some hundred times
    the rounding, and a depth of 1e-12 L for triangles of ordinary shape. So touching, coplanar
    overlap and grazing an edge or a corner are no crossing, and a triangle thinner than 1e-12 L
    cannot be pierced, though its edges can pierce others.
    Near-linear in m while the boxes are of similar size.

    Parameters
    ----------
    position
        Positions (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3).

    Returns
    -------
    Ints
        Pairs (k, 2), the smaller index first, sorted.

    Raises
    ------
    ValueError
        For positions that are not finite.
    """
    if not np.all(np.isfinite(position)):
        raise ValueError("cloth: crossing_pairs needs finite positions.")
    lower, upper = motion_boxes(position, position, triangles, 0.0)
    return crossings_among(position, triangles, near_boxes(lower, upper))
