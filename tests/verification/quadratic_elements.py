"""Free-surface slosh of a convex tank's liquid by quadratic finite elements.

Shares no code with the program. The liquid is meshed in polar coordinates about a point of its
level surface, from which all of a convex liquid is seen: x = centre + rho D(direction) direction,
with D the distance to the wall. Nine-node quadrilaterals or 27-node hexahedra stand on even levels
of rho and the angles; where rho or an angle is 0 they are degenerate, which Gauss's points do not
see. Eigenvalues are from above; their error falls with the fourth power of the elements' width
below a surface that meets the wall at 90 degrees or less, and with the power 2 pi/angle else.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import eigsh

Array = NDArray[np.float64]
Reach = Callable[[Array], Array]  # distance (n,) to the wall along unit vectors (n, d)


def _shapes(dimensions: int) -> tuple[Array, Array, Array]:
    """Values (q, 3^d), their derivatives (q, d, 3^d) and Gauss's weights (q,) on [-1, 1]^d."""
    node, weight = np.polynomial.legendre.leggauss(3)
    value = np.stack([0.5 * node * (node - 1), 1 - node**2, 0.5 * node * (node + 1)], axis=1)
    slope = np.stack([node - 0.5, -2 * node, node + 0.5], axis=1)

    def product(factors: list[Array]) -> Array:
        result = factors[0]
        for factor in factors[1:]:
            result = np.einsum("qa,pb->qpab", result, factor).reshape(len(result) * len(factor), -1)
        return result

    slopes = [
        product([slope if axis == other else value for other in range(dimensions)])
        for axis in range(dimensions)
    ]
    weights = product([weight[:, None]] * dimensions)[:, 0]
    return product([value] * dimensions), np.stack(slopes, axis=1), weights


def _elements(counts: tuple[int, ...]) -> NDArray[np.int64]:
    """Nodes (e, 3^d) of the elements of a grid of 2 n + 1 nodes in each direction."""
    number = np.arange(np.prod([2 * n + 1 for n in counts])).reshape([2 * n + 1 for n in counts])
    corner = itertools.product(*(range(0, 2 * n, 2) for n in counts))
    return np.array([number[tuple(slice(i, i + 3) for i in start)].ravel() for start in corner])


def _assembled(
    points: Array, elements: NDArray[np.int64], measure: Callable[[Array], tuple[Array, Array]]
) -> csc_array:
    """Matrix of int (grad f . grad g + c f g) w dV; ``measure`` gives w and c at points (n, d)."""
    value, slope, weight = _shapes(points.shape[1])
    corner = points[elements]
    jacobian = np.einsum("qxk,ekd->eqxd", slope, corner)
    size = np.abs(np.linalg.det(jacobian))
    gradient = np.linalg.solve(
        jacobian, np.broadcast_to(slope, (*jacobian.shape[:2], *slope.shape[1:]))
    )
    at = np.einsum("qk,ekd->eqd", value, corner)
    w, c = measure(at.reshape(-1, at.shape[2]))
    scale = size * weight * w.reshape(size.shape)
    parts = np.einsum("eq,eqxi,eqxj->eij", scale, gradient, gradient, optimize=True)
    parts += np.einsum("eq,qi,qj->eij", scale * c.reshape(size.shape), value, value, optimize=True)
    return _matrix(parts, elements, len(points))


def _surface_mass(
    points: Array, elements: NDArray[np.int64], weight_of: Callable[[Array], Array]
) -> csc_array:
    """Matrix of int f g w dA over the level surface, whose elements have a dimension less."""
    value, slope, weight = _shapes({3: 1, 9: 2}[elements.shape[1]])
    corner = points[elements]
    tangent = np.einsum("qxk,ekd->eqxd", slope, corner)
    size = np.sqrt(np.linalg.det(np.einsum("eqxd,eqyd->eqxy", tangent, tangent)))
    at = np.einsum("qk,ekd->eqd", value, corner)
    scale = size * weight * weight_of(at.reshape(-1, at.shape[2])).reshape(size.shape)
    return _matrix(np.einsum("eq,qi,qj->eij", scale, value, value), elements, len(points))


def _matrix(parts: Array, elements: NDArray[np.int64], size: int) -> csc_array:
    rows = np.broadcast_to(elements[:, :, None], parts.shape).ravel()
    columns = np.broadcast_to(elements[:, None], parts.shape).ravel()
    return csc_array(coo_array((parts.ravel(), (rows, columns)), shape=(size, size)))


def _least(
    stiffness: csc_array, mass: csc_array, points: Array, still: NDArray[np.bool_], count: int
) -> Array:
    """Least eigenvalues, points that coincide made one, f = 0 where ``still``."""
    _, first, inverse = np.unique(
        np.round(points, 10) + 0.0, axis=0, return_index=True, return_inverse=True
    )
    kept = np.flatnonzero(~still[first])
    place = np.full(len(first), -1)
    place[kept] = np.arange(len(kept))
    column = place[inverse.ravel()]
    rows = np.flatnonzero(column >= 0)
    join = csc_array(
        coo_array((np.ones(len(rows)), (rows, column[rows])), shape=(len(points), len(kept)))
    )
    k, m = csc_array(join.T @ stiffness @ join), csc_array(join.T @ mass @ join)
    # f on the surface alone has a mass: 1/lambda are the largest eigenvalues of M over K.
    return np.sort(1.0 / eigsh(m, count, k, which="LM", return_eigenvectors=False))


def axisymmetric(reach: Reach, count: int, *, modes: int = 1) -> Array:
    """omega^2/g [1/m] of the lowest modes f(r, z) cos(angle) of a liquid upright in its tank.

    ``reach``: see ``Reach``, from the middle of the surface, of directions (n, 2) in r and z, z
    upwards; ``count``: elements along rho and along the angle.
    """
    rho, alpha = np.linspace(0, 1, 2 * count + 1), np.linspace(0, np.pi / 2, 2 * count + 1)
    way = np.stack([np.sin(alpha), -np.cos(alpha)], axis=1)
    points = (rho[:, None, None] * (reach(way)[:, None] * way)).reshape(-1, 2)
    elements = _elements((count, count))
    stiffness = _assembled(
        points, elements, lambda at: (at[:, 0], 1.0 / np.maximum(at[:, 0], 1e-300) ** 2)
    )
    surface = np.arange(len(points)).reshape(len(rho), -1)[:, -1]
    lines = np.stack([surface[k : len(surface) - 2 + k : 2] for k in range(3)], axis=1)
    mass = _surface_mass(points, lines, lambda at: at[:, 0])
    return _least(stiffness, mass, points, points[:, 0] < 1e-9, modes)


def three_dimensional(reach: Reach, count: int, odd: tuple[bool, bool], *, modes: int = 1) -> Array:
    """omega^2/g [1/m] of the lowest modes of a liquid that the planes x = 0 and y = 0 mirror.

    ``reach``: see ``Reach``, from the middle of the surface, of directions (n, 3), z upwards;
    ``odd``: whether the mode changes its sign at x = 0 and at y = 0; ``count``: elements along rho
    and each of the angles, of a quarter of the liquid.
    """
    rho, angle = np.linspace(0, 1, 2 * count + 1), np.linspace(0, np.pi / 2, 2 * count + 1)
    down, around = np.meshgrid(angle, angle, indexing="ij")
    way = np.stack(
        [np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), -np.cos(down)], axis=-1
    )
    wall = reach(way.reshape(-1, 3))[:, None] * way.reshape(-1, 3)
    points = (rho[:, None, None] * wall).reshape(-1, 3)
    grid = np.arange(len(points)).reshape(len(rho), len(angle), len(angle))
    stiffness = _assembled(
        points, _elements((count,) * 3), lambda at: (np.ones(len(at)), np.zeros(len(at)))
    )
    faces = _elements((count, count))
    mass = _surface_mass(points, grid[:, -1].ravel()[faces], lambda at: np.ones(len(at)))
    still = np.zeros(len(points), dtype=bool)
    for axis in range(2):
        still |= odd[axis] & (np.abs(points[:, axis]) < 1e-9)
    return _least(stiffness, mass, points, still, modes)


def pill_reach(half: float, level: float, *, lying: bool) -> Reach:
    """Distances to the wall of a pill of radius 1 and a cylinder of 2 ``half``, by bisection.

    From the middle of a surface at ``level`` above the pill's middle, its axis upright or, where it
    is ``lying``, along x.
    """

    def inside(points: Array) -> NDArray[np.bool_]:
        if points.shape[1] == 2:
            across, along = points[:, 0], points[:, 1] + level
        elif lying:
            across, along = np.hypot(points[:, 1], points[:, 2] + level), points[:, 0]
        else:
            across, along = np.hypot(points[:, 0], points[:, 1]), points[:, 2] + level
        return np.hypot(across, np.maximum(np.abs(along) - half, 0.0)) <= 1.0

    def reach(way: Array) -> Array:
        low, high = np.zeros(len(way)), np.full(len(way), 4.0 * (1.0 + half))
        for _ in range(60):
            middle = 0.5 * (low + high)
            within = inside(middle[:, None] * way)
            low, high = np.where(within, middle, low), np.where(within, high, middle)
        return low

    return reach
