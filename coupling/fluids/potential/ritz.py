"""An inviscid, irrotational liquid in a closed shape by harmonic polynomials: no mesh, no map.

Luke's principle (J. Fluid Mech. 27, 1967): of all potentials phi the true one makes

    T = rho ( int_D phi u_n dS - 1/2 int_V |grad phi|^2 dV )

largest, with D the moving part of the boundary, and T is then the liquid's kinetic energy. Here
phi is a harmonic polynomial (Ritz). The integral of a homogeneous polynomial of degree d over a
cone to the origin is x.n/(d + 3) times it over the cone's base, so that the surface D, the
diaphragm's own triangles, and the fixed walls give the volume's integral. T is positive for any
shape, folded or thin; motions that no polynomial sees, short waves and tangential ones, carry no
kinetic energy.

Of the same action int T dt the surface's variation is the pressure p* = -rho (dphi/dt +
|grad phi|^2/2) at fixed places, a polynomial's too, so that a changing shape makes no energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg as sl

from cloth.compiled import compiled
from coupling.finite_volume.swept import cross
from coupling.fluids.potential.harmonics import SolidHarmonics
from coupling.ports import Array, Ints, Turn

# Least stiffness of a potential over the largest: a thin film has many that hardly move any liquid,
# or none by the rounding and the quadrature of its two sides.
REGULAR = 1e-9


@dataclass(frozen=True, kw_only=True)
class RitzLiquid:
    """Liquid of ``density`` [kg/m^3] between ``triangles`` (m, 3) and fixed walls.

    The triangles are counter-clockwise seen from outside the liquid. ``wall`` (k, k) [m]: the fixed
    walls' share of int grad H_i . grad H_j dV, see ``wall_integral``. ``spun`` (k, 3) [m^3]: int
    H_i (e x x).n dS over them, what they drive as they turn at 1 rad/s about each axis e;
    None of walls that never do.
    """

    triangles: Ints
    harmonics: SolidHarmonics
    wall: Array
    density: float
    spun: Array | None = None

    def at(self, points: Array) -> RitzShape:
        """The liquid below the sheet at ``points`` (n, 3) [m]."""
        corner = points[self.triangles]
        area = 0.5 * cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        values = self.harmonics.values(corner.mean(axis=1))
        reach = np.einsum("tx,tx->t", corner[:, 0], area)
        stiffness = (self.wall + cone_integral(values, reach, self.harmonics))[1:, 1:]
        flux = np.zeros((len(points), 3, values.shape[1] - 1))
        spread_flux(self.triangles, values[:, 1:], area, flux)
        return RitzShape(
            liquid=self, area=area, values=values, inverse=regular_inverse(stiffness),
            flux=flux.reshape(-1, flux.shape[2]),
        )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class RitzShape:
    """The liquid in one shape.

    ``area`` (m, 3) [m^2] of the triangles; ``values`` (m, k) of the harmonics at their centroids;
    ``inverse`` W (k - 1, k - 1) [m^(-1/2)]: W W^T is the stiffness' inverse, no constant in it;
    ``flux`` (3n, k - 1) [m^2]: int H_i n dS of each node's velocity.
    """

    liquid: RitzLiquid
    area: Array
    values: Array
    inverse: Array
    flux: Array

    def rows(self) -> Array:
        """Rows B (k - 1, n, 3) [kg^(1/2)] of the liquid's inertia M = B^T B: T = |B v|^2/2."""
        scaled = np.sqrt(self.liquid.density) * self.inverse.T @ self.flux.T
        return np.asarray(scaled).reshape(len(scaled), -1, 3)

    def walls(self) -> Array:
        """What walls that turn add to it, C (k - 1, 3) [kg^(1/2) m]: T = |B v + C omega|^2/2."""
        if self.liquid.spun is None:
            return np.zeros((len(self.inverse), 3))
        return np.asarray(np.sqrt(self.liquid.density) * self.inverse.T @ self.liquid.spun[1:])

    def source(self, velocity: Array, turn: Turn | None = None) -> Array:
        """Int H_i u_n dS (k - 1,) [m^3/s] over what moves.

        The nodes at ``velocity`` (n, 3) [m/s], and the walls of a tank that turns.
        """
        source = velocity.ravel() @ self.flux
        if turn is None or self.liquid.spun is None:
            return source
        return np.asarray(source + self.liquid.spun[1:] @ turn.rate)

    def potential(self, velocity: Array, turn: Turn | None = None) -> Array:
        """Coefficients (k,) [m^2/s] of phi; parameters as of ``source``."""
        source = self.source(velocity, turn)
        return np.concatenate([[0.0], self.inverse @ (self.inverse.T @ source)])

    def kinetic_energy(self, velocity: Array, turn: Turn | None = None) -> float:
        """T [J]; parameters as of ``source``."""
        source = self.source(velocity, turn)
        return 0.5 * self.liquid.density * float(source @ self.potential(velocity, turn)[1:])

    def pressure(self, rate: Array, coefficient: Array) -> Array:
        """Return p* on the triangles of the sheet.

        Parameters
        ----------
        rate
            Coefficients of dphi/dt (k,) [m^2/s^2].
        coefficient
            Coefficients of phi (k,) [m^2/s].

        Returns
        -------
        Array
            p* at the triangles' centroids (m,) [Pa], in the gauge of ``rate``.
        """
        return bernoulli(self.liquid, self.values, rate, coefficient)[0]

    def force(self, pressure: Array) -> Array:
        """Nodal forces (n, 3) [N] of ``pressure`` (m,) [Pa], towards the outside."""
        force = np.zeros((len(self.flux) // 3, 3))
        share = np.repeat(pressure[:, None] * self.area / 3.0, 3, axis=0)
        np.add.at(force, self.liquid.triangles.ravel(), share)
        return force


def regular_inverse(stiffness: Array) -> Array:
    """Return W (k, k): W W^T is the inverse of a ``stiffness`` (k, k) of ``REGULAR`` and more."""
    value, vector = sl.eigh(stiffness, check_finite=False)
    return np.asarray(vector / np.sqrt(np.maximum(value, REGULAR * value[-1])))


def bernoulli(
    liquid: RitzLiquid, values: Array, rate: Array, coefficient: Array
) -> tuple[Array, Array]:
    """Return p* = -rho (dphi/dt + |grad phi|^2/2) and the speed |grad phi|.

    Parameters
    ----------
    liquid
        The liquid, with its density and harmonics.
    values
        Values of the harmonics (N, k) [-] at the points where p* is wanted.
    rate
        Coefficients of dphi/dt (k,) [m^2/s^2].
    coefficient
        Coefficients of phi (k,) [m^2/s].

    Returns
    -------
    pressure : Array
        p* (N,) [Pa], in the gauge of ``rate``.
    speed : Array
        |grad phi| (N,) [m/s].
    """
    slopes = (values @ (slope @ coefficient) for slope in liquid.harmonics.slopes)
    square = sum((slope**2 for slope in slopes), np.zeros(len(values)))
    return -liquid.density * (values @ rate + 0.5 * square), np.sqrt(square)


def cone_integral(values: Array, reach: Array, harmonics: SolidHarmonics) -> Array:
    """Return int grad H_i . grad H_j dV over the cone from the origin to a surface.

    Parameters
    ----------
    values
        Values of the harmonics (N, k) [-] at the surface's samples.
    reach
        x.n dS of the samples (N,) [m^3].
    harmonics
        The k harmonics H.

    Returns
    -------
    Array
        Symmetric matrix (k, k) [m].
    """
    product = values.T @ (reach[:, None] * values)
    total = sum((slope.T @ product @ slope for slope in harmonics.slopes), 0.0 * product)
    degree = harmonics.degrees  # a gradient's product has the degree a - 1 + b - 1
    return np.asarray(total / np.maximum(degree[:, None] + degree[None, :] + 1, 1))


def wall_integral(harmonics: SolidHarmonics, points: Array, area: Array) -> Array:
    """Return the ``cone_integral`` of fixed walls; the origin may lie anywhere.

    Parameters
    ----------
    harmonics
        The k harmonics.
    points
        Samples on the walls (N, 3) [m].
    area
        Their area vectors (N, 3) [m^2], which point out of the liquid.

    Returns
    -------
    Array
        Symmetric matrix (k, k) [m].
    """
    return cone_integral(harmonics.values(points), np.sum(points * area, axis=1), harmonics)


@compiled
def spread_flux(triangles: Ints, values: Array, area: Array, flux: Array) -> None:
    """Add a third of a triangle's values times its area to each of its nodes.

    Parameters
    ----------
    triangles
        Nodes of each triangle (m, 3).
    values
        Values on the triangles (m, k), of any unit.
    area
        Area vectors of the triangles (m, 3) [m^2].
    flux
        Sums (n, 3, k) [m^2 times the unit], added to here.
    """
    for t in range(triangles.shape[0]):
        for i in triangles[t]:
            for axis in range(3):
                share = area[t, axis] / 3.0
                for k in range(values.shape[1]):
                    flux[i, axis, k] += share * values[t, k]
