"""Plain NumPy definitions of the compiled kernels of self-contact. Slow, and meant to be read."""

from __future__ import annotations

import numpy as np
from scipy.optimize import lsq_linear

from cloth.arrays import Array, Bools, Ints
from cloth.self_contact.planes import PRECISION
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


def project_planes(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    radius: float,
    sweeps: int,
    friction: float,
    start: Array,
    z: Array,
    beyond: Array,
    rub: Array,
    pushed: Array,
) -> None:
    """Project ``z`` (n, 3) [m] on the half-spaces and on the ball of ``radius`` [m].

    In the metric of the masses: plane k, with the multiplier ``pushed``_k >= 0, moves its nodes by
    dz_i = d w_i n / m_i over sum_j w_j^2 / m_j, d the gap that lacks, or what can be taken back of
    former pushes that are no longer needed; and a ball by what is ``beyond`` (n, 3) [m] it. With
    that memory sweeps over all planes converge to the nearest point of all sets at once, as ADMM
    needs it (Hildreth 1957; Boyle and Dykstra 1986); without it to any point of all sets. They end
    after ``sweeps``, or one whose largest push is below ``PRECISION`` of the first.
    With ``friction`` mu a plane that pushes by p also takes back what its sides slid on each other
    since ``start`` (n, 3) [m], along the plane, but at most mu p. ``rub`` (n, 3) [m] takes that
    change. ``beyond`` is what the ball has taken of z so far, and is changed. ``pushed`` (k,) [m]
    is 0 at first.
    """
    held = np.zeros((len(nodes), 3))

    def move(i: Ints, share: Array, way: Array) -> None:
        moved = share != 0.0
        place = z[i] + np.outer(share, way) + beyond[i]
        shrink = np.minimum(1.0, radius / np.maximum(np.linalg.norm(place, axis=1), 1e-30))
        z[i] = np.where(moved[:, None], shrink[:, None] * place, z[i])
        beyond[i] = np.where(moved[:, None], place - z[i], beyond[i])

    def visit(k: int) -> float:
        i, w, n = nodes[k], weights[k], normal[k]
        total = inverse_mass[i] @ w**2
        if total <= 0.0:
            return 0.0
        share = inverse_mass[i] * w / total
        lacking = max(rest[k] - n @ (w @ z[i]), -pushed[k])
        if lacking != 0.0:
            pushed[k] += lacking
            move(i, lacking * share, n)
        if not (friction > 0.0 and (pushed[k] > 0.0 or held[k].any())):
            return float(abs(lacking))
        slip = w @ (z[i] - start[i])
        slip = slip - (n @ slip) * n + held[k]
        slip *= min(1.0, friction * pushed[k] / max(float(np.linalg.norm(slip)), 1e-300))
        taken, held[k] = slip - held[k], slip
        rub[i] -= np.outer(share, taken)
        move(i, -share, taken)
        return float(max(abs(lacking), np.abs(taken).max()))

    first = 0.0
    for sweep in range(sweeps):
        most = max(visit(k) for k in range(len(nodes)))
        first = most if sweep == 0 else first
        if most <= PRECISION * first:
            break


def plane_step(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    radius: float,
    weight: Array,
    sweeps: int,
    friction: float,
    start: Array,
    z: Array,
    u: Array,
    rub: Array,
    pressing: Array,
    rhs: Array,
) -> None:
    """Continue ``cloth.node_reference.contact_step`` with its ball cut by the planes.

    With y = z + u as that step left them, z becomes the projection also on the planes, u = y - z,
    and ``rhs`` (n, 3) [N] takes the change of weight (z - u). Nodes of ``weight`` 0 stay out.
    ``rub`` (n, 3) [N] becomes the friction that each node exerts, and ``pressing`` (n, 2) [N] the
    force with which the shell presses on each node, and the sum of those of the planes. Plane k
    presses with w_c/m p_k over sum_j w_j^2 / m_j, w_c/m the penalty over the mass, the same of all
    nodes that have one; each of its nodes has the share |w_i| of that.
    """
    before = z.copy()
    pushed = np.zeros(len(nodes))
    rub[:] = 0.0
    outward = np.maximum(np.einsum("id,id->i", u, z), 0.0)
    beyond = outward[:, None] / np.maximum(np.einsum("id,id->i", z, z), 1e-60)[:, None] * z
    project_planes(
        nodes,
        weights,
        normal,
        rest,
        inverse_mass,
        radius,
        sweeps,
        friction,
        start,
        z,
        beyond,
        rub,
        pushed,
    )
    pressing[:, 0], pressing[:, 1] = weight * np.linalg.norm(beyond, axis=1), 0.0
    total = np.einsum("ki,ki->k", inverse_mass[nodes], weights**2)
    force = (weight * inverse_mass)[nodes].max(axis=1) * pushed / np.maximum(total, 1e-300)
    np.add.at(pressing[:, 1], nodes, np.abs(weights) * force[:, None])
    rub *= -weight[:, None]
    change = np.where(weight[:, None] > 0.0, z - before, 0.0)
    u -= change
    rhs += 2.0 * weight[:, None] * change
