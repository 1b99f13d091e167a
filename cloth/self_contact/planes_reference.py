"""Plain NumPy definitions of the compiled kernels of ``planes``. Slow, and meant to be read."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.self_contact.planes import PRECISION


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
