"""The liquid's inertia on its interface, by the Neumann Laplacian of the flow's or a coarser mesh.

The operator answers what OpenFOAM answers to an acceleration of the diaphragm from rest: the same
cells, the same face coefficients (``Gauss linear corrected``), the same wall pressure. A coupling
scheme that takes it into the structure's inertia therefore has little left to iterate; an
under-estimate of any short wave would diverge. Only what ``skewCorrected`` adds to the gradients
of non-orthogonal fluxes is left out, half a per cent: it would take a third layer of neighbours.
OpenFOAM's answer on the wall is not quite symmetric, by 1 per cent of its norm on a bent mesh; the
structure takes the symmetric part, and the rest is iterated. Where the walls' library has not been
built, OpenFOAM lacks the walls' own pressure that is part of this operator, some per cent of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array, eye_array
from scipy.sparse.linalg import splu

from coupling.finite_volume.coarsening import Coarsening
from coupling.finite_volume.geometry import CellGeometry, cell_geometry, face_centres_and_areas
from coupling.finite_volume.gradients import gradients, wall_distance
from coupling.finite_volume.laplacian import SYMMETRIC, eliminated, wall_layer, wall_source
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.swept import swept_rows
from coupling.ports import Array


class NeumannLaplacian:
    """The Laplacian of the cells of ``mesh`` at ``geometry``, no flux through any wall, eliminated.

    One cell is held: pressures are defined up to a constant, which the callers' means remove.
    """

    def __init__(self, mesh: LiquidMesh, geometry: CellGeometry) -> None:
        self.mesh, self.geometry = mesh, geometry
        cells = eliminated(mesh)
        self._order, self._wall = cells.order, cells.wall
        self._gradients = gradients(mesh, geometry)
        # relax: with SuperLU's own merging of columns it takes twice as long here.
        matrix = cells.matrix(mesh, geometry, self._gradients.cells)
        self._solver = splu(matrix, permc_spec="NATURAL", relax=1, **SYMMETRIC)
        assert np.array_equal(self._solver.perm_r, np.arange(len(self._order))), "a pivot has moved"

    def trace(self) -> Array:
        """G (F, F) [1/m]: p_f = -rho (G a)_f for accelerations a of the flux [m^3/s^2], Sum a = 0.

        p_f is the wall's value: the cell's, what its gradient adds along the wall, and the
        acceleration over the half cell. Symmetric;
        accelerations with a net flux are answered up to a constant.
        """
        # With the wall's cells last, what is left of the others' elimination is the trace's
        # inverse: no pressure inside need be found.
        mesh, inner = self.mesh, len(self._order) - len(self._wall)
        lower, upper = (part[inner:, inner:].toarray() for part in (self._solver.L, self._solver.U))
        face = np.searchsorted(self._wall, mesh.owner[mesh.diaphragm])
        within = np.linalg.inv(lower @ upper)[np.ix_(face, face)]
        # A flux acts on the cells below too, and the wall's value takes theirs. How p is there
        # follows from what flows out of the wall's: two-point fluxes will do for a correction.
        beside, down = wall_layer(mesh, self.geometry)
        below = within - (np.eye(len(face)) - beside @ within) / down[:, None]
        own = wall_source(mesh, self.geometry)[mesh.owner[mesh.diaphragm]].toarray()
        rest = -1.0 - own.sum(axis=0)  # of a flux, in the cell below
        value, value_below = self._wall_weights()
        trace = -value @ (within @ own + below.T * rest)
        trace -= value_below[:, None] * (below @ own + below.T * rest)
        patch_area = np.linalg.norm(self.geometry.face_area[mesh.diaphragm], axis=1)
        half_cell = wall_distance(mesh, self.geometry) / patch_area
        return np.asarray(0.5 * (trace + trace.T) + np.diag(half_cell))

    def _wall_weights(self) -> tuple[Array, Array]:
        """Weights of the wall's cells (F, F) and of those below (F,) in the diaphragm's values."""
        mesh, count = self.mesh, self.mesh.diaphragm_faces
        own, faces = mesh.owner[mesh.diaphragm], np.full(mesh.cells, -1)
        faces[own] = np.arange(count)
        weight, beside = self._gradients.walls[:count], faces[self._gradients.columns[own]]
        value = np.zeros((count, count + 1))
        np.add.at(value, (np.arange(count)[:, None], beside), weight)  # -1: below
        return value[:, :count], value[:, count]

    def pressure(self, rate: Array) -> Array:
        """p/rho (c,) [m^2/s^2] in the cells that fluxes changing by ``rate`` ask for.

        ``rate`` (B,) [m^3/s^2], one for each boundary face, without a sum.
        """
        mesh, count = self.mesh, self.mesh.diaphragm_faces
        source = wall_source(mesh, self.geometry) @ rate[:count]
        source -= np.bincount(mesh.owner[mesh.inner_faces + count :], rate[count:], mesh.cells)
        pressure = np.zeros(mesh.cells)
        pressure[self._order] = self._solver.solve(source[self._order])
        return pressure


@dataclass(frozen=True, kw_only=True)
class LiquidInertia:
    """A liquid's inertia M_a = B^T B on its interface, at one shape of it: see the port.

    B = L C of the faces of the mesh that the operator is found on, the flow's own or a coarser one:
    ``factor`` L (r, k) [kg^(1/2)/m^2]; ``swept`` C (k, 3 p) [m^2], the volumes that they sweep per
    displacement of the points, component by component of each; ``shares`` (k, F): of the flow's
    faces in them. Uniform pressures are left out.
    """

    factor: Array
    swept: csr_array
    shares: csr_array

    @classmethod
    def of(cls, laplacian: NeumannLaplacian, patch: Array, density: float) -> LiquidInertia:
        """That on the diaphragm's points, found on the flow's own mesh.

        Parameters
        ----------
        laplacian
            Of the cells where they are.
        patch
            The points there (p, 3) [m].
        density
            Of the liquid [kg/m^3].

        Returns
        -------
        LiquidInertia
            Exact factor of the discrete operator to rounding.
        """
        mesh = laplacian.mesh
        area = np.linalg.norm(laplacian.geometry.face_area[mesh.diaphragm], axis=1)
        return cls(
            factor=_factor(density * laplacian.trace(), area),
            swept=swept_rows(patch, mesh.patch_faces),
            shares=csr_array(eye_array(len(area))),
        )

    @classmethod
    def on(
        cls, coarser: Coarsening, mesh: LiquidMesh, points: Array, density: float
    ) -> LiquidInertia:
        """The same, found on a coarser mesh than the flow's.

        A coarse face's flux is the sum of its shares in the flow's faces, and its pressure stands
        on all of them. Of a wave of number k along square faces of width h on deep liquid, this
        makes the inertia s (1 + s^2)^(1/2)/x times the exact one, x = k h/2 and s = sin x: the
        two-point scheme finds too much, and the mean over a face leaves too little. That lies
        between 1 and 1.11 where h is below .42 of the wavelength, is .9 at half of it, and falls
        fast beyond: the coarse faces must be finer than the structure's shortest waves.

        Parameters
        ----------
        coarser
            The coarser mesh.
        mesh, points
            The flow's, and where its points (P, 3) [m] are.
        density
            Of the liquid [kg/m^3].

        Returns
        -------
        LiquidInertia
            On the points of the flow's diaphragm.
        """
        geometry = cell_geometry(coarser.mesh, coarser.points @ points)
        laplacian = NeumannLaplacian(coarser.mesh, geometry)
        patch = points[mesh.patch_points]
        normal = face_centres_and_areas(patch[mesh.patch_faces])[1]
        # The areas are those of the flow's faces, so that a uniform lift has no inertia here too.
        area = coarser.faces @ np.linalg.norm(normal, axis=1)
        return cls(
            factor=_factor(density * laplacian.trace(), area),
            swept=csr_array(coarser.faces @ swept_rows(patch, mesh.patch_faces)),
            shares=coarser.faces,
        )

    @property
    def rows(self) -> Array:
        """B (r, p, 3) [kg^(1/2)] on the points."""
        return self.weighted((self.swept.toarray()).reshape(len(self.factor[0]), -1, 3))

    def weighted(self, swept: Array) -> Array:
        """B (r, n, 3) [kg^(1/2)] of volumes (k, n, 3) [m^2] that the operator's faces sweep."""
        return np.tensordot(self.factor, swept, 1)

    def force(self, acceleration: Array) -> Array:
        """M_a a (p, 3) [N] of accelerations (p, 3) [m/s^2]: what has to push the liquid."""
        return np.asarray(self.swept.T @ self._pressure(acceleration)).reshape(-1, 3)

    def pressure(self, acceleration: Array) -> Array:
        """The same as pressures (F,) [Pa] on the flow's faces."""
        return np.asarray(self.shares.T @ self._pressure(acceleration))

    def _pressure(self, acceleration: Array) -> Array:
        """On the operator's faces (k,) [Pa]."""
        flux = self.factor @ (self.swept @ acceleration.ravel())
        return np.asarray(self.factor.T @ flux)


def _factor(operator: Array, area: Array) -> Array:
    """L (r, k) with L^T L = ``operator`` (k, k), means over faces of ``area`` (k,) removed.

    They are removed on both sides: a uniform pressure is the volume constraint's business.
    """
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    operator = mean @ operator @ mean.T
    value, vector = np.linalg.eigh(0.5 * (operator + operator.T))
    kept = value > 1e-12 * value[-1]
    return np.ascontiguousarray((vector[:, kept] * np.sqrt(value[kept])).T)
