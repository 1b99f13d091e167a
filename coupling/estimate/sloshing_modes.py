"""Lateral sloshing of a ball's liquid, by a method that shares nothing with the solvers.

The Rayleigh quotient of phi(r, z) cos(angle) over polynomials of high degree on the meridian
(p-version finite elements, one element). Its coordinates are like polar ones about the corner of
surface and wall, where phi goes with the distance to the power pi over the corner's angle.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre
from threadpoolctl import threadpool_limits

from coupling.ports import Array

DEGREE = 28  # along the surface; half of it across
FEW, FULL = 16, 1.8  # a degree that serves the first mode up to this level


def lateral_eigenvalue(level: float, mode: int, *, degree: int = DEGREE) -> float:
    """omega^2 R/g of the ``mode``-th lateral mode (m = 1) at the depth ``level`` over R.

    Agrees with McIver (J. Fluid Mech. 201, 1989) to all digits of his table. From above, and to
    1e-6 and better for the lowest three modes and levels from 0.2 to 1.8. With ``degree`` 16, a
    tenth of the work, the first mode is as good up to 1.6, and within 2e-5 at 1.8.
    """
    with threadpool_limits(1):
        stiffness, mass = _forms(level, degree, degree // 2)
        # Heights on the surface alone: 1/lambda are the largest eigenvalues of M over K. With
        # K = L L^T, as LAPACK has it; NumPy does, and SciPy takes long to import.
        root = np.linalg.cholesky(stiffness)
        reduced = np.linalg.solve(root, np.linalg.solve(root, mass).T)
        value = np.linalg.eigvalsh(0.5 * (reduced + reduced.T))
    return float(1 / value[-mode])


def layer_slip(level: float, mode: int) -> tuple[float, float]:
    """Return what the boundary layers of a lateral mode take, of the wall and of the surface.

    Each is R int |u_t|^2 dA/int |grad phi|^2 dV, u_t the flow along the boundary. Times
    sqrt(nu omega/2)/R it is the rate at which the mode's energy falls, as
    ``fluids.potential.wall_layers`` derives it; the surface's share is that of one with a cover
    which does not move along itself.

    Parameters
    ----------
    level
        Depth of the liquid over the radius, h/R in (0, 2); not checked.
    mode
        Number of the mode, from 1.

    Returns
    -------
    wall, surface : float
        Both dimensionless; half full 1.956 and 2.178 of the first mode.
    """
    vector, (node, weight) = _mode(level, mode), legendre.leggauss(2 * DEGREE)
    node, weight = (node + 1) / 2, weight / 2
    angle, shares = float(np.arccos(1 - level)), []
    for t, radius, length in (
        (1.0, np.sin(angle * node), angle),
        (0.0, np.sin(angle) * node, float(np.sin(angle))),
    ):
        value, slope, _ = _basis(node, np.full_like(node, t), DEGREE, DEGREE // 2)
        along, around = vector @ slope / length, vector @ value / radius
        shares.append(float((along**2 + around**2) @ (weight * radius * length)))
    return shares[0], shares[1]


def lateral_heights(level: float, mode: int, distance: Array) -> Array:
    """Return the heights of a lateral mode's surface, over cos(angle), the largest near 1.

    Parameters
    ----------
    level
        Depth of the liquid over the radius, h/R in (0, 2); not checked.
    mode
        Number of the mode, from 1.
    distance
        Distances (q,) from the axis, over the radius of the surface.

    Returns
    -------
    Array
        Heights (q,) [-].
    """
    rim = np.append(distance, np.linspace(0.0, 1.0, 101))
    surface = _basis(rim, np.zeros_like(rim), DEGREE, DEGREE // 2)[0]
    heights = _mode(level, mode) @ surface
    return np.asarray(heights[: len(distance)] / heights[np.argmax(np.abs(heights[-101:])) - 101])


def mode_shares(level: float, count: int) -> Array:
    """Return the share of the liquid's mass that swings with each of the first lateral modes.

    As an oscillator with that mass and the mode's frequency the mode pushes the tank along x:
    m_k = rho omega_k^2/g (int x phi dA)^2/int phi^2 dA over the surface (Abramson, NASA SP-106,
    1966). A half-full ball's are 0.580, 0.015 and 0.004.

    Parameters
    ----------
    level
        Depth of the liquid over the radius, h/R in (0, 2); not checked.
    count
        Number of modes.

    Returns
    -------
    Array
        Shares (``count``,) [-].
    """
    node, weight = legendre.leggauss(2 * DEGREE)
    node, weight = (node + 1) / 2, weight / 2
    surface = _basis(node, np.zeros_like(node), DEGREE, DEGREE // 2)[0]
    rim = np.sqrt(level * (2 - level))
    # Over pi: int x phi dA; of unit Dirichlet integral int phi^2 dA is the inverse eigenvalue.
    lever = surface @ (weight * rim**3 * node**2)
    volume = level**2 * (3 - level) / 3
    return np.array(
        [
            (lateral_eigenvalue(level, mode) * (_mode(level, mode) @ lever)) ** 2 / volume
            for mode in range(1, count + 1)
        ]
    )


def _mode(level: float, mode: int) -> Array:
    """Coefficients (b,) of a lateral mode, of unit Dirichlet integral over pi."""
    with threadpool_limits(1):
        stiffness, mass = _forms(level, DEGREE, DEGREE // 2)
        root = np.linalg.cholesky(stiffness)
        reduced = np.linalg.solve(root, np.linalg.solve(root, mass).T)
        vectors = np.linalg.eigh(0.5 * (reduced + reduced.T))[1]
        return np.asarray(np.linalg.solve(root.T, vectors[:, -mode]))


@lru_cache(maxsize=64)
def slosh_eigenvalue(level: float) -> float:
    """lambda = omega^2 R/g of the first free-surface mode at h/R = ``level`` in (0, 2).

    Computed in 10 ms, above 1.8 in 0.1 s: within 2e-5 up to 1.9 (a fill fraction of 0.993). From
    there it rises as a small opening's, to 2.754755 R/a with a its radius (Henrici, Troesch &
    Wuytack, ZAMP 21 (1970) 285), and is 2 % above that at 1.999. Mass, tension and bending of a
    diaphragm are left out. ``ValueError`` outside (0, 2).
    """
    if not 0.0 < level < 2.0:
        raise ValueError(f"level h/R: must lie in (0, 2), got {level:g}.")
    return lateral_eigenvalue(level, 1, degree=FEW if level <= FULL else DEGREE)


def covered_eigenvalue(eigenvalue: float, cover: float) -> float:
    """Return omega^2 R/g of a mode below a limp cover, from its ``eigenvalue`` without one.

    ``cover``: mass per area over rho R; the cover moves with the surface. A level cover's weight
    adds no stiffness, and its inertia acts as so much less gravity, of every mode alike, exactly:

    1/lambda' = 1/lambda + cover.
    """
    return 1.0 / (1.0 / eigenvalue + cover)


def surface_inertia(level: float, node: Array, weight: Array, heights: Array) -> Array:
    """Return twice the liquid's kinetic energy, over pi rho R^3, for given rates of its surface.

    The entry for two rates of height is the integral over the surface of the one times the
    potential of the other.

    Parameters
    ----------
    level
        Depth of the liquid over the radius, h/R in (0, 2); not checked.
    node
        Distances (q,) of the quadrature's points from the axis, over the radius of the surface.
    weight
        Weights (q,) [-] of a quadrature over [0, 1], exact for degree 2 ``DEGREE`` at least.
    heights
        Rates of height (k, q) at the points, of any unit u; each is that times cos(angle).

    Returns
    -------
    Array
        Symmetric matrix (k, k) [u^2].

    Notes
    -----
    Heights that vary over lengths much shorter than pi R/``DEGREE`` are not resolved.
    """
    from scipy.linalg import solve

    stiffness, _ = _forms(level, DEGREE, DEGREE // 2)
    surface = _basis(node, np.zeros_like(node), DEGREE, DEGREE // 2)[0]
    square = 1.0 - (level - 1.0) ** 2
    swept = (surface * weight * square * node) @ heights.T
    return np.asarray(swept.T @ solve(stiffness, swept, assume_a="pos"))


def _forms(level: float, along: int, across: int) -> tuple[Array, Array]:
    """Matrices of the Dirichlet integral and of the surface's mass, over pi."""
    node, weight = legendre.leggauss(2 * along)
    node, weight = (node + 1) / 2, weight / 2
    s, t = (grid.ravel() for grid in np.meshgrid(node, node, indexing="ij"))
    values, by_s, by_t = _basis(s, t, along, across)
    angle = np.arccos(1 - level)  # from the bottom to the corner
    rim, height = np.sin(angle), level - 1
    # Straight lines from the surface to the wall; s = 1 is the corner, s = 0 the axis.
    r = (1 - t) * rim * s + t * np.sin(angle * s)
    r_s, r_t = (1 - t) * rim + t * angle * np.cos(angle * s), np.sin(angle * s) - rim * s
    z_s, z_t = t * angle * np.sin(angle * s), -np.cos(angle * s) - height
    size = np.abs(r_s * z_t - r_t * z_s)
    by_r, by_z = by_s * z_t - by_t * z_s, by_t * r_s - by_s * r_t
    measure = np.outer(weight, weight).ravel() * r
    stiffness = (by_r * measure / size) @ by_r.T + (by_z * measure / size) @ by_z.T
    stiffness += (values * measure * size / r**2) @ values.T
    surface = _basis(node, np.zeros_like(node), along, across)[0]
    return stiffness, (surface * weight * rim**2 * node) @ surface.T


def _basis(s: Array, t: Array, along: int, across: int) -> tuple[Array, Array, Array]:
    """Functions (b, q) at s, t and their derivatives: zero on the axis, one value in the corner."""
    left, left_slope = _polynomials(s, along)
    right, right_slope = _polynomials(t, across)
    inside = s * (1 - s)
    values = [s * left]
    by_s = [left + s * left_slope]
    by_t = [np.zeros_like(left)]
    for k in range(1, across):
        values.append(inside * left * right[k])
        by_s.append(((1 - 2 * s) * left + inside * left_slope) * right[k])
        by_t.append(inside * left * right_slope[k])
    return np.concatenate(values), np.concatenate(by_s), np.concatenate(by_t)


def _polynomials(x: Array, count: int) -> tuple[Array, Array]:
    """Legendre polynomials (count, q) on [0, 1] and their derivatives."""
    values = np.asarray(legendre.legvander(2 * x - 1, count - 1).T, dtype=np.float64)
    slopes = [legendre.legval(2 * x - 1, legendre.legder(row)) for row in np.eye(count)]
    return values, np.asarray(2 * np.array(slopes), dtype=np.float64)
