"""Plain NumPy definitions of what ``cloth.node_kernels`` compiles. Slow, and meant to be read."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from cloth.arrays import Array, Ints


def contact_step(
    x: Array,
    radius: float,
    weight: Array,
    relaxation: float,
    friction: float,
    start: Array,
    z: Array,
    u: Array,
    rub: Array,
    rhs: Array,
) -> None:
    """Keep |x_i| <= ``radius`` [m] by projecting on the ball; changes ``z``, ``u`` (n, 3) [m].

    ``weight`` (n,) [N/m] of a node, 0 leaves it out; the contact force is weight u [N]. With a
    coefficient of ``friction`` mu a node that is beyond the ball sticks where the ray through its
    ``start`` (n, 3) [m] meets the ball, if y - z is in Coulomb's cone there, |tangential| <= mu
    normal; else z lies on the great circle from y to that place, where it is on the cone's edge:
    in y's own plane, sin(a - atan mu) = -sin(atan mu) ``radius``/|y|, a the angle from y to z.
    ``rub`` (n, 3) [N] becomes the tangential part of the force on the shell. The compiled twin
    takes any shell's ``profile`` in place of the radius (``cloth.shell.kernels.settle_on``).
    """
    rub[:] = 0.0
    on = weight > 0.0
    y = relaxation * x[on] + (1.0 - relaxation) * z[on] + u[on]
    distance = np.linalg.norm(y, axis=1)
    scale = np.minimum(1.0, radius / distance)
    z[on] = scale[:, None] * y
    if friction > 0.0:
        outward = y / distance[:, None]
        place = start[on] / np.linalg.norm(start[on], axis=1)[:, None]
        cosine = np.einsum("id,id->i", outward, place)
        across = place - cosine[:, None] * outward
        sine = np.linalg.norm(across, axis=1)
        across /= np.where(sine > 0.0, sine, 1.0)[:, None]
        cone = np.arctan(friction)
        turn = np.minimum(cone - np.arcsin(np.sin(cone) * scale), np.arctan2(sine, cosine))
        turned = np.cos(turn)[:, None] * outward + np.sin(turn)[:, None] * across
        touching = (distance > radius)[:, None]
        z[on] = np.where(touching, radius * turned, z[on])
    u[on] = y - z[on]
    if friction > 0.0:
        along = np.einsum("id,id->i", u[on], turned)[:, None] * turned
        rub[on] = np.where(touching, weight[on][:, None] * (u[on] - along), 0.0)
    rhs[on] += weight[on, None] * (z[on] - u[on])


def bending_rest_step(
    gradient: Array, starts: Ints, columns: Ints, values: Array, moment: Array, rhs: Array
) -> None:
    """Add R^T (m n), of the moulded curvature, to ``rhs`` (n, 3) [N].

    ``starts``, ``columns``, ``values``: rows of R as in ``cloth.bending.Bending``; m = ``moment``
    (n,) [N m^3]; n = g/|g| of the volume's ``gradient`` g (n, 3) [m^2], 0 of nodes without a
    normal. With ``bending_turning_step`` the force of the energy -sum_i m_i n_i.(R x)_i; the other
    part of the energy, x.Q x/2, stands in the matrix.
    """
    size = np.linalg.norm(gradient, axis=1)
    normals = gradient / np.where(size > 0.0, size, 1.0)[:, None]
    rows = sp.csr_matrix((values, columns, starts), shape=(len(moment), len(moment)))
    rhs += np.asarray(rows.T @ (moment[:, None] * normals))


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
    """Add the force of sum_i m_i n_i.(R x)_i that turns the normals n to ``rhs`` (n, 3) [N].

    Arguments as of ``bending_rest_step``, with the positions ``x`` (n, 3) [m] whose ``gradient`` it
    is. The derivative of sum_i q_i.g_i with q = m (1 - n n^T) R x/|g|, where a triangle of edges
    a, b from its first node adds a x b/6 to g of its three nodes. R x is along n, and the force
    none, where the sheet does not stretch.
    """
    square = np.einsum("id,id->i", gradient, gradient)[:, None]
    size = np.sqrt(np.where(square > 0.0, square, 1.0))
    normals = gradient / size
    rows = sp.csr_matrix((values, columns, starts), shape=(len(moment), len(moment)))
    lean = np.asarray(rows @ x)
    lean = lean - np.einsum("id,id->i", lean, normals)[:, None] * normals
    turn = np.where(square > 0.0, moment[:, None] / size * lean, 0.0)
    corner, whole = x[triangles], turn[triangles].sum(axis=1) / 6.0
    first, second = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    one, two = np.cross(second, whole), np.cross(whole, first)
    np.add.at(rhs, triangles, np.stack([-one - two, one, two], axis=1))


def normal_drag_step(x: Array, anchor: Array, gradient: Array, drag: Array, rhs: Array) -> None:
    """Hand back the normal part of the drag: rhs += drag n n^T (x - anchor).

    ``drag`` (n,) [N/m], mass times rate over b; normals along ``gradient`` (n, 3), any length.
    """
    on = (np.einsum("id,id->i", gradient, gradient) > 0.0) & (drag > 0.0)
    normal = gradient[on] / np.linalg.norm(gradient[on], axis=1)[:, None]
    along = np.einsum("id,id->i", normal, x[on] - anchor[on])
    rhs[on] += (drag[on] * along)[:, None] * normal
