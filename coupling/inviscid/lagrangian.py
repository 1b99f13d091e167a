"""The liquid's kinetic energy as a function of shape and velocity, and its derivatives.

T(x, v) = rho/2 q^T G(x) q, q = C(x) v: one Lagrangian for all inertial forces on the points,
d/dt (rho C^T phi) - dT/dx with phi = G q. With the exact gradient of the discrete T a changing
shape creates no energy.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from coupling.interface import cross, swept_gradient
from coupling.inviscid.adjoint import influence_slopes
from coupling.inviscid.kernels import least_square
from coupling.inviscid.operator import BoundaryIntegrals, boundary_integrals
from coupling.inviscid.panels import COARSE, FINE, film_scale, kept_off, rule, topology
from coupling.inviscid.symmetric import SymmetricTrace
from coupling.ports import Array, Ints


class Kinetic(NamedTuple):
    """``energy`` T [J]; ``gradient`` dT/dx (p, 3) [N] at fixed velocity; ``phi`` (F,) [m^2/s].

    ``flux`` q (F,) [m^3/s]; the momentum conjugate to the points is rho C^T phi.
    """

    energy: float
    gradient: Array
    phi: Array
    flux: Array


def kinetic_gradient(
    points: Array,
    faces: Ints,
    velocity: Array,
    *,
    radius: float,
    wall_share: float,
    clearance: float,
    density: float,
) -> Kinetic:
    """Kinetic energy of the liquid below a sheet that moves with ``velocity`` (p, 3) [m/s].

    Its gradient is the exact derivative of the discrete energy, in closed form: the time of
    a few operators, however many points there are. ``density`` [kg/m^3]; the rest as in
    ``operator.ball_trace``.
    """
    integrals = boundary_integrals(
        points, faces, radius=radius, wall_share=wall_share, clearance=clearance
    )
    corner, speed = points[faces], velocity[faces]
    flux = np.einsum("fkx,fkx->f", swept_gradient(corner), speed)
    trace = SymmetricTrace(integrals.single, integrals.double)
    phi = trace.apply(flux)
    known = topology(faces, len(points))
    kept = kept_off(points, known.edge, radius, clearance)
    gradient = np.zeros_like(points)
    by_corner = _by_shape(kept, faces, radius, integrals, *trace.slopes(flux))
    np.add.at(gradient, faces, by_corner)
    if clearance > 0:
        scale, rate = film_scale(points, known.edge, radius, clearance)
        distance = np.maximum(np.linalg.norm(points, axis=1), 1e-300)
        along = np.einsum("px,px->p", points, gradient) * rate / distance
        gradient = scale[:, None] * gradient + along[:, None] * points
    np.add.at(gradient, faces, 2 * phi[:, None, None] * flux_gradient(corner, speed))
    return Kinetic(
        energy=0.5 * density * float(flux @ phi),
        gradient=0.5 * density * gradient,
        phi=phi,
        flux=flux,
    )


def flux_gradient(corner: Array, speed: Array) -> Array:
    """Derivative (F, k, 3) [m^2/s] of the fluxes of ``speed`` (F, k, 3) by ``corner``."""
    apart = corner - corner.mean(axis=1, keepdims=True)
    weight = (speed + np.roll(speed, -1, axis=1) + speed.mean(axis=1, keepdims=True)) / 6.0
    by_apart = cross(np.roll(apart, -1, axis=1), weight)
    by_apart += np.roll(cross(weight, apart), 1, axis=1)
    return np.asarray(by_apart - by_apart.mean(axis=1, keepdims=True))


def _by_shape(
    points: Array,
    faces: Ints,
    radius: float,
    integrals: BoundaryIntegrals,
    by_single: Array,
    by_double: Array,
) -> Array:
    """Derivative (F, k, 3) by the corners of sum_ij (s_ij S_ij + d_ij K_ij), s and d held."""
    corner, touching = points[faces], topology(faces, len(points)).touching
    rules = [rule(corner.shape[1], number) for number in (COARSE, FINE)]
    (near, coarse), (fine, areas) = (r.sample(corner) for r in rules)
    samples = (near, coarse, fine, areas)
    slopes = [np.zeros_like(array) for array in samples]
    least = least_square(points, radius)
    size = np.sqrt((areas**2).sum(axis=2, keepdims=True) + least)
    total = size.sum(axis=1)[:, 0]
    slopes[3] -= ((by_single * integrals.single).sum(axis=0) / total)[:, None, None] * areas / size
    by_single = by_single / total
    by_centre = np.zeros((len(corner), 3))
    influence_slopes(
        corner.mean(axis=1), near, coarse, fine, areas, touching, radius, least,
        by_single, by_double, by_centre, slopes[0], slopes[1], slopes[2], slopes[3],
    )  # fmt: skip
    result = _own_gradient(corner) * (np.diag(by_single) / (4 * np.pi))[:, None, None]
    result += by_centre[:, None] / corner.shape[1]
    for r, by_points, by_areas in zip(rules, slopes[::2], slopes[1::2], strict=True):
        along, across = r.along @ corner, r.across @ corner
        result += r.shape.T @ by_points
        result += r.along.T @ cross(across, by_areas) + r.across.T @ cross(by_areas, along)
    return np.asarray(result)


def _own_gradient(corner: Array) -> Array:
    """Derivative (F, k, 3) of ``kernels.own_potential`` from the mean of the corners."""
    a = corner - corner.mean(axis=1, keepdims=True)
    b = np.roll(a, -1, axis=1)
    normal, edge = cross(a, b), b - a
    double_area, length, far, near = (
        np.linalg.norm(vector, axis=2, keepdims=True) for vector in (normal, edge, b, a)
    )
    sides = near + far
    open_ = double_area > 1e-12 * length * sides
    double_area, length, near, far, sides = (
        np.where(open_, array, blank)
        for array, blank in zip(
            (double_area, length, near, far, sides), (1.0, 1.0, 1.0, 1.0, 2.0), strict=True
        )
    )
    logarithm = np.log((sides + length) / (sides - length))
    by_area = logarithm / length
    by_sides = double_area / length * (1 / (sides + length) - 1 / (sides - length))
    by_length = double_area / length * (1 / (sides + length) + 1 / (sides - length))
    by_length -= double_area * logarithm / length**2
    unit = normal / double_area
    by_a = by_area * cross(b, unit) + by_sides * a / near - by_length * edge / length
    by_b = by_area * cross(unit, a) + by_sides * b / far + by_length * edge / length
    total = np.where(open_, by_a, 0.0) + np.roll(np.where(open_, by_b, 0.0), 1, axis=1)
    return np.asarray(total - total.mean(axis=1, keepdims=True))
