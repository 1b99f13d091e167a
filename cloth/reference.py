"""Plain NumPy definitions of what ``cloth.kernels`` compiles. Slow, and meant to be read."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.bending import hinge_normals


def softened(stretch: Array, penalty: Array, tensile: float, compressive: float) -> Array:
    """Principal stretches sigma' after the projection.

    sigma' = (k sigma + K)/(k + K) minimises k (sigma' - sigma)^2 + K (sigma' - 1)^2: ``penalty``
    k [N/m] and the sheet's own stiffness K [N/m], ``tensile`` above 1 (negative: inextensible,
    sigma' = 1) and ``compressive`` below (0: free to wrinkle, sigma' = sigma).
    """
    soft = (penalty * stretch + compressive) / (penalty + compressive)
    taut = (
        np.ones_like(stretch)
        if tensile < 0.0
        else (penalty * stretch + tensile) / (penalty + tensile)
    )
    return np.where(stretch > 1.0, taut, soft)


def membrane_step(
    x: Array,
    triangles: Ints,
    gradients: Array,
    areas: Array,
    penalty: Array,
    relaxation: float,
    tensile: float,
    compressive: float,
    z: Array,
    u: Array,
    rhs: Array,
) -> None:
    """Project every triangle's stretch and add its pull to ``rhs`` (n, 3) [N].

    y = r F(x) + (1 - r) z + u; z = y with its singular values softened; u = y - z. ``z`` and
    ``u`` (m, 3, 2) [-] are changed; the tension is k u [N/m]. rhs += sum_t k A (z - u) g^T.
    """
    stretch = np.einsum("tid,tie->tde", x[triangles], gradients)
    y = relaxation * stretch + (1.0 - relaxation) * z + u
    left, sigma, right = np.linalg.svd(y, full_matrices=False)
    new = softened(sigma, penalty[:, None], tensile, compressive)
    z[:] = left * new[:, None, :] @ right
    u[:] = y - z
    pull = (penalty * areas)[:, None, None] * np.einsum("tde,tie->tid", z - u, gradients)
    np.add.at(rhs, triangles, pull)


def principal_strains(x: Array, triangles: Ints, gradients: Array, strain: Array) -> float:
    """Largest principal strain sigma_max - 1 of every triangle into ``strain`` (m,)."""
    stretch = np.einsum("tid,tie->tde", x[triangles], gradients)
    strain[:] = np.linalg.norm(stretch, ord=2, axis=(1, 2)) - 1.0
    return float(strain.max())


def contact_step(
    x: Array, limit: Array, weight: Array, relaxation: float, z: Array, u: Array, rhs: Array
) -> None:
    """Keep |x_i| <= ``limit`` (n,) [m] by projecting on the ball; changes ``z``, ``u`` (n, 3) [m].

    ``weight`` (n,) [N/m] of a node, 0 leaves it out; the contact force is weight u [N].
    """
    on = weight > 0.0
    y = relaxation * x[on] + (1.0 - relaxation) * z[on] + u[on]
    scale = np.minimum(1.0, limit[on] / np.linalg.norm(y, axis=1))
    z[on] = scale[:, None] * y
    u[on] = y - z[on]
    rhs[on] += weight[on, None] * (z[on] - u[on])


def volume_and_loads(
    x: Array, triangles: Ints, slope: Array, free: Bools, gradient: Array, hydrostatic: Array
) -> float:
    """Signed volume [m^3] of the cone from the origin over the cloth, and the load of its pressure.

    ``gradient`` (n, 3) [m^2] becomes dV/dx of the free nodes: p0 times it is the load of a uniform
    pressure p0. ``hydrostatic`` (n, 3) [N] becomes that of p = slope . x, ``slope`` (3,) [Pa/m]:
    the gradient of the integral of p over the liquid, exact for the polyhedron (the mean of p over
    a triangle weighted by the node's hat function). Exact for free nodes only, whose triangles
    close a fan; fixed nodes get zero.
    """
    corner = x[triangles]
    normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]) / 6.0
    pressure = corner @ slope
    weighted = 0.25 * (pressure + pressure.sum(axis=1)[:, None])
    gradient[:] = 0.0
    hydrostatic[:] = 0.0
    np.add.at(gradient, triangles, np.repeat(normal[:, None, :], 3, axis=1))
    np.add.at(hydrostatic, triangles, weighted[:, :, None] * normal[:, None, :])
    gradient[~free] = 0.0
    hydrostatic[~free] = 0.0
    return float(np.einsum("td,td->", corner[:, 0], normal))


def bending_rest_step(
    x: Array, nodes: Ints, coefficients: Array, moment: Array, rhs: Array
) -> None:
    """Add the moulded curvature's part of the bending force to ``rhs`` (n, 3) [N].

    ``moment`` (e,) [N] is weight times curvature; the hinge normal is taken at ``x`` and its own
    derivative left out. The other part, -Q x, stands in the matrix.
    """
    normals = hinge_normals(x, nodes)
    pull = (moment[:, None] * coefficients)[:, :, None] * normals[:, None, :]
    np.add.at(rhs, nodes, pull)


def normal_drag_step(x: Array, anchor: Array, gradient: Array, drag: Array, rhs: Array) -> None:
    """Hand back the normal part of the drag: rhs += drag n n^T (x - anchor).

    ``drag`` (n,) [N/m], mass times rate over b; normals along ``gradient`` (n, 3), any length.
    """
    on = (np.einsum("id,id->i", gradient, gradient) > 0.0) & (drag > 0.0)
    normal = gradient[on] / np.linalg.norm(gradient[on], axis=1)[:, None]
    along = np.einsum("id,id->i", normal, x[on] - anchor[on])
    rhs[on] += (drag[on] * along)[:, None] * normal
