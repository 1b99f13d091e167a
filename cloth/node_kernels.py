"""What acts on nodes: the compiled twins of ``cloth.node_reference``, as in ``cloth.kernels``."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.shell.kernels import into_sphere, nearest_within, settle_on


@compiled
def contact_step(
    x: Array,
    profile: Array,
    weight: Array,
    relaxation: float,
    friction: float,
    start: Array,
    z: Array,
    u: Array,
    rub: Array,
    rhs: Array,
) -> None:
    """See ``cloth.node_reference.contact_step``."""
    y, normal = np.empty(3), np.empty(3)
    sphere = profile.shape[0] == 1 and profile.shape[1] == 1
    for i in range(x.shape[0]):
        rub[i, 0] = rub[i, 1] = rub[i, 2] = 0.0
        if weight[i] <= 0.0:
            continue
        for d in range(3):
            y[d] = relaxation * x[i, d] + (1.0 - relaxation) * z[i, d] + u[i, d]
        touching = False
        if friction > 0.0:
            touching = settle_on(profile, y, friction, start[i], z[i], normal)
        elif sphere:
            z[i, 0], z[i, 1], z[i, 2] = into_sphere(profile[0, 0], y[0], y[1], y[2])
        else:
            z[i, 0], z[i, 1], z[i, 2] = nearest_within(profile, y[0], y[1], y[2])
        u[i, 0], u[i, 1], u[i, 2] = y[0] - z[i, 0], y[1] - z[i, 1], y[2] - z[i, 2]
        if touching and friction > 0.0:
            along = u[i, 0] * normal[0] + u[i, 1] * normal[1] + u[i, 2] * normal[2]
            for d in range(3):
                rub[i, d] = weight[i] * (u[i, d] - along * normal[d])
        for d in range(3):
            rhs[i, d] += weight[i] * (z[i, d] - u[i, d])


@compiled
def bending_rest_step(
    gradient: Array, starts: Ints, columns: Ints, values: Array, moment: Array, rhs: Array
) -> None:
    """See ``cloth.node_reference.bending_rest_step``."""
    for i in range(moment.shape[0]):
        g0, g1, g2 = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        square = g0 * g0 + g1 * g1 + g2 * g2
        if square <= 0.0:
            continue
        scale = moment[i] / math.sqrt(square)
        g0, g1, g2 = scale * g0, scale * g1, scale * g2
        for p in range(starts[i], starts[i + 1]):
            j, w = columns[p], values[p]
            rhs[j, 0] += w * g0
            rhs[j, 1] += w * g1
            rhs[j, 2] += w * g2


@compiled
def bending_turning_step(
    x: Array,
    triangles: Ints,
    gradient: Array,
    starts: Ints,
    columns: Ints,
    values: Array,
    moment: Array,
    rhs: Array,
) -> None:
    """See ``cloth.node_reference.bending_turning_step``."""
    turn = np.zeros_like(x)
    for i in range(moment.shape[0]):
        g0, g1, g2 = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        square = g0 * g0 + g1 * g1 + g2 * g2
        if square <= 0.0:
            continue
        r0, r1, r2 = 0.0, 0.0, 0.0
        for p in range(starts[i], starts[i + 1]):
            j, w = columns[p], values[p]
            r0, r1, r2 = r0 + w * x[j, 0], r1 + w * x[j, 1], r2 + w * x[j, 2]
        along = (r0 * g0 + r1 * g1 + r2 * g2) / square
        scale = moment[i] / (6.0 * math.sqrt(square))
        turn[i, 0] = scale * (r0 - along * g0)
        turn[i, 1] = scale * (r1 - along * g1)
        turn[i, 2] = scale * (r2 - along * g2)
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        q0 = turn[i, 0] + turn[j, 0] + turn[k, 0]
        q1 = turn[i, 1] + turn[j, 1] + turn[k, 1]
        q2 = turn[i, 2] + turn[j, 2] + turn[k, 2]
        a0, a1, a2 = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        b0, b1, b2 = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        e0, e1, e2 = b1 * q2 - b2 * q1, b2 * q0 - b0 * q2, b0 * q1 - b1 * q0
        f0, f1, f2 = q1 * a2 - q2 * a1, q2 * a0 - q0 * a2, q0 * a1 - q1 * a0
        rhs[j, 0], rhs[j, 1], rhs[j, 2] = rhs[j, 0] + e0, rhs[j, 1] + e1, rhs[j, 2] + e2
        rhs[k, 0], rhs[k, 1], rhs[k, 2] = rhs[k, 0] + f0, rhs[k, 1] + f1, rhs[k, 2] + f2
        rhs[i, 0], rhs[i, 1], rhs[i, 2] = (
            rhs[i, 0] - e0 - f0,
            rhs[i, 1] - e1 - f1,
            rhs[i, 2] - e2 - f2,
        )


@compiled
def normal_drag_step(x: Array, anchor: Array, gradient: Array, drag: Array, rhs: Array) -> None:
    """See ``cloth.node_reference.normal_drag_step``."""
    for i in range(x.shape[0]):
        g0, g1, g2 = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        square = g0 * g0 + g1 * g1 + g2 * g2
        if square <= 0.0 or drag[i] <= 0.0:
            continue
        d = g0 * (x[i, 0] - anchor[i, 0])
        d += g1 * (x[i, 1] - anchor[i, 1]) + g2 * (x[i, 2] - anchor[i, 2])
        d *= drag[i] / square
        rhs[i, 0] += d * g0
        rhs[i, 1] += d * g1
        rhs[i, 2] += d * g2


@compiled
def node_step(
    x: Array,
    profile: Array,
    weight: Array,
    relaxation: float,
    friction: float,
    start: Array,
    z: Array,
    u: Array,
    rub: Array,
    triangles: Ints,
    gradient: Array,
    starts: Ints,
    columns: Ints,
    values: Array,
    moment: Array,
    damped: Array,
    anchor: Array,
    drag: Array,
    rhs: Array,
) -> None:
    """Add what acts on the nodes to ``rhs``: shell contact, bending and drag, in one call.

    It calls ``contact_step``, ``bending_rest_step``, ``bending_turning_step`` and
    ``normal_drag_step`` in this order; see ``cloth.node_reference`` for each.

    Parameters
    ----------
    x
        Positions (n, 3) [m].
    profile
        The shell, as ``cloth.shell.kernels`` describes it.
    weight
        Penalty of the shell (n,) [N/m]; 0 leaves a node out.
    relaxation, friction
        Over-relaxation r [-], and Coulomb's coefficient on the shell [-].
    start
        Positions (n, 3) [m] at the step's start.
    z, u
        Place within the shell and scaled dual (n, 3) [m]; both are changed.
    rub
        Becomes the friction that each node exerts on the shell (n, 3) [N].
    triangles
        Nodes of each triangle (m, 3).
    gradient
        Gradient of the volume (n, 3) [m^2], along the normals.
    starts, columns, values
        Rows of R [1/m^3], as in ``cloth.bending.Bending``.
    moment, damped
        The nodes' moment (n,) [N m^3] in ``bending_turning_step``, and in ``bending_rest_step``.
    anchor, drag
        Position anchor of the step (n, 3) [m], and drag (n,) [N/m].
    rhs
        Forces (n, 3) [N], to which all is added.
    """
    contact_step(x, profile, weight, relaxation, friction, start, z, u, rub, rhs)
    bending_rest_step(gradient, starts, columns, values, damped, rhs)
    bending_turning_step(x, triangles, gradient, starts, columns, values, moment, rhs)
    normal_drag_step(x, anchor, gradient, drag, rhs)
