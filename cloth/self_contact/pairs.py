"""Pairs of a sheet's primitives that may touch during a step, and the positions that part them."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled
from cloth.self_contact.crossing import share_node
from cloth.self_contact.proximity import VERTEX, approach, difference, meeting, nearest
from cloth.shell.kernels import keep_within

STOP = 0.1  # share of the gap at the start, or of the thickness, that a motion must leave
GROWTH = 0.05  # of the thickness, by which a gap below it may grow within a step
SLACK = 0.1  # of the rest distance, that is not worth a correction


@compiled
def _gather(x: Array, nodes: Ints, p: Array) -> None:
    for i in range(4):
        for d in range(3):
            p[i, d] = x[nodes[i], d]


@compiled
def _spread(x: Array, triangles: Ints, s: int, t: int, n0: float, n1: float, n2: float) -> float:
    """How far the triangle ``s`` lies beyond ``t`` along (n0, n1, n2), times its length."""
    low, high = np.inf, -np.inf
    for i in range(3):
        j, k = triangles[s, i], triangles[t, i]
        low = min(low, n0 * x[j, 0] + n1 * x[j, 1] + n2 * x[j, 2])
        high = max(high, n0 * x[k, 0] + n1 * x[k, 1] + n2 * x[k, 2])
    return low - high


@compiled
def approaching_kernel(
    start: Array, end: Array, centres: Array, triangles: Ints, near: Ints, margin: float
) -> Ints:
    """See ``cloth.self_contact.reference.approaching_kernel``."""
    found, count = np.empty_like(near), 0
    for pair in range(near.shape[0]):
        s, t = near[pair, 0], near[pair, 1]
        if share_node(triangles, s, t):
            continue
        n0, n1 = centres[s, 0] - centres[t, 0], centres[s, 1] - centres[t, 1]
        n2 = centres[s, 2] - centres[t, 2]
        least = margin * math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
        if (
            _spread(start, triangles, s, t, n0, n1, n2) <= least
            or _spread(end, triangles, s, t, n0, n1, n2) <= least
        ):
            found[count, 0], found[count, 1] = s, t
            count += 1
    return found[:count].copy()


@compiled
def _separates(p: Array, q: Array, first: int, n: Array, margin: float) -> bool:
    """Whether planes normal to ``n`` (3,) keep the sides apart from ``p`` to ``q`` (4, 3)."""
    low_p, low_q, high_p, high_q = np.inf, np.inf, -np.inf, -np.inf
    for i in range(4):
        at_p = n[0] * p[i, 0] + n[1] * p[i, 1] + n[2] * p[i, 2]
        at_q = n[0] * q[i, 0] + n[1] * q[i, 1] + n[2] * q[i, 2]
        if i < first:
            low_p, low_q = min(low_p, at_p), min(low_q, at_q)
        else:
            high_p, high_q = max(high_p, at_p), max(high_q, at_q)
    least = margin * math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
    return low_p - high_p > least and low_q - high_q > least


@compiled
def candidate_kernel(
    start: Array, end: Array, pairs: Ints, margin: float, gaps: Array, kept: Bools
) -> None:
    """See ``cloth.self_contact.reference.candidate_kernel``."""
    p, q, w, out = np.empty((4, 3)), np.empty((4, 3)), np.empty(4), np.empty(3)
    for k in range(len(pairs)):
        first = 1 if pairs[k, 0] == VERTEX else 2
        _gather(start, pairs[k, 1:], p)
        _gather(end, pairs[k, 1:], q)
        gaps[k] = nearest(pairs[k, 0], p, w, out)
        kept[k] = gaps[k] - approach(pairs[k, 0], p, q) <= margin
        if kept[k] and _separates(p, q, first, out, margin):
            kept[k] = False
        if kept[k]:
            nearest(pairs[k, 0], q, w, out)
            kept[k] = not _separates(p, q, first, out, margin)


@compiled
def _push(
    x: Array, inverse_mass: Array, profile: Array, nodes: Ints, w: Array, n: Array, amount: float
) -> bool:
    """Widen the gap along ``n`` (3,) by ``amount`` [m] at once, lighter nodes moving more.

    Whether anything can move; nodes are kept in the shell of this ``profile``.
    """
    total = 0.0
    for i in range(4):
        total += inverse_mass[nodes[i]] * w[i] * w[i]
    if total <= 0.0:
        return False
    for i in range(4):
        k = nodes[i]
        share = amount * inverse_mass[k] * w[i] / total
        if share == 0.0:
            continue
        for d in range(3):
            x[k, d] += share * n[d]
        keep_within(profile, x[k])
    return True


@compiled
def _lacking(
    time: float, distance: float, stop: float, along: float, end: float, rest: float
) -> float:
    """How much [m] a pair must be pushed at the end of its motion, 0 if not at all.

    ``distance`` at the meeting ``time``, ``along`` its normal at the end of the motion and ``end``
    the distance there. A pair that meets on its way but ends apart is pushed until it would not.
    """
    if distance <= stop and time < 1.0:
        return max(rest - along, min(rest, (0.5 * rest - distance) / max(time, 0.1)))
    return rest - end if end < (1.0 - SLACK) * rest else 0.0


@compiled
def separation_rounds(
    start: Array,
    x: Array,
    inverse_mass: Array,
    profile: Array,
    pairs: Ints,
    gaps: Array,
    thickness: float,
    rounds: int,
    met: Bools,
) -> int:
    """Push all pairs apart, one after the other, until none is pushed or the rounds are used up.

    Parameters
    ----------
    start
        Positions (n, 3) [m] at the start of the motion.
    x
        Positions (n, 3) [m] at its end, which are changed.
    inverse_mass
        Inverse mass of the nodes (n,) [1/kg]; 0 where one must not move.
    profile
        The shell that nodes are kept in, as ``cloth.shell.kernels`` describes it.
    pairs, gaps
        Pairs (k, 5) and their distances at the start (k,) [m], as ``candidate_kernel`` has them.
    thickness
        Distance [m] to which pairs are pushed.
    rounds
        Number of rounds over all pairs, at most.
    met
        Becomes true (k,) where the motion from ``start`` to ``x`` may not be free of contact.

    Returns
    -------
    int
        Number of pairs pushed in the last round: with 0, ``met`` holds for the final ``x`` (and is
        false except where nothing can move).
    """
    moved, seen = np.ones(len(x), dtype=np.int64), np.zeros(len(pairs), dtype=np.int64)
    p, w, out, clock, pushed = np.empty((3, 4, 3)), np.empty(4), np.empty(3), 1, len(pairs)
    for _ in range(rounds):
        pushed = 0
        for k in range(len(pairs)):
            nodes = pairs[k, 1:]
            latest = max(max(moved[nodes[0]], moved[nodes[1]]), moved[nodes[2]])
            if max(latest, moved[nodes[3]]) <= seen[k]:
                continue
            _gather(start, nodes, p[0])
            _gather(x, nodes, p[1])
            rest = min(thickness, gaps[k] + GROWTH * thickness)
            stop = STOP * min(gaps[k], thickness)
            time, distance = meeting(pairs[k, 0], p[0], p[1], stop, w, p[2], out)
            met[k] = distance <= stop
            seen[k] = clock
            length, along = difference(p[2], w, out), 0.0
            for i in range(4):
                for d in range(3):
                    along += w[i] * out[d] * p[1, i, d] / max(length, 1e-30)
            amount = _lacking(time, distance, stop, along, distance, rest)
            if amount <= 0.0 or length <= 0.0:
                continue
            for d in range(3):
                out[d] /= length
            if _push(x, inverse_mass, profile, nodes, w, out, amount):
                pushed += 1
                clock += 1
                for i in range(4):
                    moved[nodes[i]] = clock
        if pushed == 0:
            break
    return pushed


@compiled
def end_gaps(x: Array, pairs: Ints, gap: Array, weights: Array, normal: Array) -> None:
    """Fill the distance of every pair, and its nearest points, at given positions.

    Parameters
    ----------
    x
        Positions (n, 3) [m].
    pairs
        Kind and four nodes of each pair (k, 5).
    gap, weights, normal
        Become the distance (k,) [m], the nearest points' weights (k, 4) and the unit vector
        (k, 3) between them, from the second side to the first.
    """
    p = np.empty((4, 3))
    for k in range(len(pairs)):
        _gather(x, pairs[k, 1:], p)
        gap[k] = nearest(pairs[k, 0], p, weights[k], normal[k])
        for d in range(3):
            normal[k, d] /= max(gap[k], 1e-30)
