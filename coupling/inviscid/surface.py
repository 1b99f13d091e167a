"""What the potential on a sheet says of the flow beside it: speed, pressure, momentum."""

from __future__ import annotations

import numpy as np

from coupling.interface import cross
from coupling.inviscid.panels import topology
from coupling.ports import Array, Ints


def area_vectors(corner: Array) -> Array:
    """Area vectors (F, 3) [m^2] of faces ``corner`` (F, k, 3), out of the liquid."""
    apart = corner - corner.mean(axis=1, keepdims=True)
    return np.asarray(0.5 * cross(apart, np.roll(apart, -1, axis=1)).sum(axis=1))


def surface_gradient(points: Array, faces: Ints, values: Array) -> Array:
    """Gradient (F, 3) along the sheet of face means ``values`` (F,), of first order.

    Least squares over the faces that touch a face, weighted by the inverse square of the distance,
    in the face's tangent plane. ``points`` (p, 3) [m], ``faces`` (F, k).
    """
    corner = points[faces]
    normal = area_vectors(corner)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    centre = corner.mean(axis=1)
    one, other = np.nonzero(topology(faces, len(points)).touching & ~np.eye(len(faces), dtype=bool))
    reach = centre[other] - centre[one]
    weight = 1.0 / np.maximum(np.einsum("ex,ex->e", reach, reach), 1e-300)
    reach -= np.einsum("ex,ex->e", reach, normal[one])[:, None] * normal[one]
    matrix = normal[:, :, None] * normal[:, None, :]  # holds the normal part at zero
    right = np.zeros_like(centre)
    np.add.at(matrix, one, weight[:, None, None] * reach[:, :, None] * reach[:, None, :])
    np.add.at(right, one, (weight * (values[other] - values[one]))[:, None] * reach)
    return np.asarray(np.linalg.pinv(matrix, hermitian=True) @ right[:, :, None])[:, :, 0]


def surface_speed(points: Array, faces: Ints, flux: Array, phi: Array) -> Array:
    """|u|^2 (F,) [m^2/s^2] of the liquid at the sheet, normal and along it.

    ``flux`` (F,) [m^3/s] through the faces and ``phi`` (F,) [m^2/s], means over them.
    """
    area = np.linalg.norm(area_vectors(points[faces]), axis=1)
    along = surface_gradient(points, faces, phi)
    return np.asarray((flux / area) ** 2 + np.einsum("fx,fx->f", along, along))


def surface_pressure(
    points: Array, faces: Ints, velocity: Array, phi: Array, phi_rate: Array, density: float
) -> Array:
    """p* (F,) [Pa] up to a constant, from Bernoulli's equation at faces that move.

    p*/rho = -(dphi/dt - w_t . grad_s phi - w_n^2/2 + |grad_s phi|^2/2), dphi/dt ``phi_rate`` (F,)
    [m^2/s^2] on the moving faces; w the faces' mean of ``velocity`` (p, 3) [m/s].
    """
    normal = area_vectors(points[faces])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    speed = velocity[faces].mean(axis=1)
    through = np.einsum("fx,fx->f", speed, normal)
    along = surface_gradient(points, faces, phi)  # its scalar product with w takes w_t alone
    convected = np.einsum("fx,fx->f", speed, along)
    kinetic = 0.5 * np.einsum("fx,fx->f", along, along)
    return np.asarray(-density * (phi_rate - convected - 0.5 * through**2 + kinetic))


def liquid_momentum(points: Array, faces: Ints, flux: Array, density: float) -> Array:
    """Momentum (3,) [kg m/s] of the liquid: rho times the integral of x u_n, u_n 0 on the wall.

    ``flux`` (F,) [m^3/s], of zero sum. The faces' means stand for x: of second order.
    """
    return np.asarray(density * flux @ points[faces].mean(axis=1))
