"""The liquid's inertia on its interface, by the Neumann Laplacian of the flow's own mesh.

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
from scipy.sparse.linalg import splu

from coupling.finite_volume.geometry import CellGeometry
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

    ``rows`` B = L C (r, p, 3) [kg^(1/2)] on the points; ``factor`` L (r, F) [kg^(1/2)/m^2] on the
    faces; C is the faces' swept volume per displacement. Uniform pressures are left out.
    """

    rows: Array
    factor: Array

    @classmethod
    def of(cls, laplacian: NeumannLaplacian, patch: Array, density: float) -> LiquidInertia:
        """That on the diaphragm's points ``patch`` (p, 3) [m], where the cells are.

        Means over the interface are removed on both sides: a uniform pressure is the volume
        constraint's business. ``density`` [kg/m^3]. Exact factor of the discrete operator to
        rounding.
        """
        mesh, geometry = laplacian.mesh, laplacian.geometry
        area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
        mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
        operator = density * mean @ laplacian.trace() @ mean.T
        value, vector = np.linalg.eigh(0.5 * (operator + operator.T))
        kept = value > 1e-12 * value[-1]
        factor = (vector[:, kept] * np.sqrt(value[kept])).T  # (r, F)
        swept = swept_rows(patch, mesh.patch_faces)
        return cls(rows=np.tensordot(factor, swept, axes=1), factor=factor)

    def force(self, acceleration: Array) -> Array:
        """M_a a (p, 3) [N] of accelerations (p, 3) [m/s^2]: what has to push the liquid."""
        return np.tensordot(np.tensordot(self.rows, acceleration, 2), self.rows, 1)

    def pressure(self, acceleration: Array) -> Array:
        """The same as pressures (F,) [Pa] on the faces."""
        return np.asarray(self.factor.T @ np.tensordot(self.rows, acceleration, 2))
