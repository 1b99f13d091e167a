"""Irrotational liquid: hydrostatics plus p* = -rho (dphi/dt + |grad phi|^2/2), all of it.

The potential is a harmonic polynomial in the true shape (``ritz``): the sheet's
own triangles bound the liquid, from a thin film to a full tank, and no mesh has to follow them.
Viscosity acts in the boundary layers along the walls alone (``wall_layers``).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from coupling.finite_volume.swept import cross
from coupling.fluids.gauge import largest_rate
from coupling.fluids.potential.harmonics import harmonics_in
from coupling.fluids.potential.ritz import (
    RitzLiquid,
    RitzShape,
    bernoulli,
    wall_integral,
)
from coupling.fluids.potential.surface_waves import slowest_wave
from coupling.fluids.potential.wall_layers import WallLayers, slip_form
from coupling.interface.contact_distance import ContactDistance
from coupling.ports import Array, Ints, LiquidSample, Shell, Turn

_ROUNDING = 1e-12  # of a lever, over the product of its parts


class PotentialLiquid:
    """Liquid of ``density`` [kg/m^3] between a ``shell`` and ``triangles`` (m, 3).

    The triangles, over ``nodes`` points, are counter-clockwise seen from the gas, their border on
    the shell's rim. ``degree`` of the polynomials: 8 is 80 unknowns. ``layer`` [m/s]: the
    ``layer_speed`` of the boundary layers, 0 for a liquid without viscosity.
    """

    def __init__(
        self,
        triangles: Ints,
        nodes: int,
        *,
        shell: Shell,
        degree: int,
        density: float,
        layer: float = 0.0,
    ) -> None:
        harmonics = harmonics_in(shell, degree)
        points, self._shell_area = shell.quadrature(degree)
        self._lever = _lever(points, self._shell_area)
        self.shell, self.layer = shell, layer
        self._distance = ContactDistance(triangles, shell)
        self.ritz = RitzLiquid(
            triangles=triangles, harmonics=harmonics,
            wall=wall_integral(harmonics, points, self._shell_area), density=density,
            spun=harmonics.values(points).T @ self._lever,
        )  # fmt: skip
        self._shell_values = harmonics.values(points)
        size = np.linalg.norm(self._shell_area, axis=1)
        outward = self._shell_area / size[:, None]
        self._shell_form = slip_form(harmonics, self._shell_values, outward, size)
        self._corners = triangles.ravel(), np.repeat(np.arange(len(triangles)), 3)
        self._nodes = nodes

    def at(self, points: Array) -> RitzShape:
        """The liquid below the sheet at ``points`` (n, 3) [m]."""
        return self.ritz.at(points)

    def slowest_wave(self, points: Array, gravity: Array) -> float:
        """Return the frequency [Hz] of the slowest wave, as of a liquid without a sheet on it.

        0 where the sheet lies on the shell all over.

        Parameters
        ----------
        points
            Nodes of the sheet at rest (n, 3) [m].
        gravity
            The body force (3,) [m/s^2] in which it is at rest.
        """
        shape, strength = self.at(points), float(np.linalg.norm(gravity))
        level = np.maximum(shape.area @ (-gravity / strength), 0.0)
        surface = np.where(self._free(points), level, 0.0)
        wave = slowest_wave(shape.values[:, 1:], surface, shape.inverse)
        return float(np.sqrt(strength * wave) / (2.0 * np.pi))

    def layers(self, points: Array, shape: RitzShape) -> WallLayers:
        """Return the boundary layers on shell and sheet of the liquid in ``shape``.

        Below the sheet at ``points`` (n, 3) [m]. Where the sheet lies on the shell's wetted side
        there is no liquid between them: what the shell's integral has there is taken off again.
        """
        size = np.linalg.norm(shape.area, axis=1)
        normal = shape.area / size[:, None]
        centre = points[self.ritz.triangles].mean(axis=1)
        # A sheet on the shell's wetted side, above no liquid, looks against the shell's normal.
        cosine = np.einsum("tx,tx->t", normal, self.shell.normal(centre))
        dry = (cosine < -0.5) & ~self._free(points)
        sheet = slip_form(self.ritz.harmonics, shape.values, normal, np.where(dry, -size, size))
        return WallLayers(
            shape=shape, speed=self.layer, form=(self._shell_form + sheet)[1:, 1:],
            wetted=np.where(dry, 0.0, size),
        )  # fmt: skip

    def sample(
        self,
        points: Array,
        shape: RitzShape,
        rate: Array,
        coefficient: Array,
        *,
        work: float,
        energy: float,
        slip: float,
    ) -> LiquidSample:
        """Return what the liquid does at a step's end, with its pressure on the sheet's triangles.

        The largest speed is the one on the diaphragm. The shell's pressure beyond the contact curve
        meets that on the sheet which lies on it, and both cancel in the force.

        Parameters
        ----------
        points
            Nodes of the sheet (n, 3) [m].
        shape
            The liquid as the step took it, below the sheet there.
        rate
            Coefficients of dphi/dt (k,) [m^2/s^2].
        coefficient
            Coefficients of phi (k,) [m^2/s].
        work
            Work of p* on the sheet in the step [J].
        energy
            Kinetic energy of the liquid [J].
        slip
            int of the squared speed along all wetted walls, relative to them [m^4/s^2].

        Returns
        -------
        LiquidSample
            The sample; its faces are the sheet's triangles (m,).
        """
        pressure, speed = bernoulli(self.ritz, shape.values, rate, coefficient)
        on_shell, _ = bernoulli(self.ritz, self._shell_values, rate, coefficient)
        nodal = shape.force(pressure)
        size, free = np.linalg.norm(shape.area, axis=1), self._free(points)
        free |= not free.any()  # a full tank's sheet rests on the shell all over
        return LiquidSample(
            face_pressure=pressure - pressure @ size / size.sum(),
            kinetic_pressure=-0.5 * self.ritz.density * speed**2,
            viscous_traction=np.zeros(len(speed)),
            wall_pressure_force=nodal.sum(axis=0) + on_shell @ self._shell_area,
            wall_pressure_moment=np.cross(points, nodal).sum(axis=0) + on_shell @ self._lever,
            speed_max=float(speed.max()),
            dphi_dt_max=largest_rate((shape.values @ rate)[free], size[free]),
            kinetic_energy=energy,
            wall_slip=slip,
            pressure_work=work,
        )

    def wall_power(self, rate: Array, coefficient: Array, turn: Turn | None) -> float:
        """Return what p* does on a shell that turns [W]; parameters as of ``sample``."""
        if turn is None:
            return 0.0
        return float(self.wall_moment(rate, coefficient) @ turn.rate)

    def wall_moment(self, rate: Array, coefficient: Array) -> Array:
        """Return the moment (3,) [N m] of p* on the shell; parameters as of ``sample``."""
        pressure, _ = bernoulli(self.ritz, self._shell_values, rate, coefficient)
        return np.asarray(pressure @ self._lever)

    def _free(self, points: Array) -> NDArray[np.bool_]:
        """Triangles (m,) with a corner more than half an edge off what rests on the shell."""
        free = (self._distance.of(points) > 0.5)[self.ritz.triangles].any(axis=1)
        return np.asarray(free)

    def to_nodes(self, points: Array, values: Array) -> Array:
        """``values`` (m, k) on triangles at ``points`` (n, 3) [m], averaged by area to the nodes.

        Returns (n, k).
        """
        corner = points[self.ritz.triangles]
        normal = cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        rows, columns = self._corners
        weight = np.linalg.norm(normal, axis=1)[columns]
        whole = np.bincount(rows, weight, self._nodes)
        sums = [np.bincount(rows, weight * part[columns], self._nodes) for part in values.T]
        return np.asarray((np.array(sums) / whole).T)


def _lever(points: Array, area: Array) -> Array:
    """Return x x n dS of a shell's samples.

    Parameters
    ----------
    points, area
        Samples (N, 3) [m] and their area vectors (N, 3) [m^2].

    Returns
    -------
    Array
        Levers (N, 3) [m^3], 0 where they are rounding: of a sphere about its middle.
    """
    lever = np.cross(points, area)
    size = np.linalg.norm(points, axis=1) * np.linalg.norm(area, axis=1)
    return np.where(np.abs(lever) > _ROUNDING * size[:, None], lever, 0.0)
