"""The liquid's added mass, by the finite-volume Neumann Laplacian of the flow's own mesh.

The operator answers what OpenFOAM answers to an acceleration of the diaphragm from rest: the same
cells, the same face coefficients (``Gauss linear corrected``), the same wall pressure. A coupling
scheme that takes it into the structure's inertia therefore has little left to iterate; an
under-estimate of any short wave would diverge.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse.linalg import splu

from coupling.foam.geometry import CellGeometry
from coupling.foam.laplacian import SYMMETRIC, eliminated
from coupling.foam.mesh import LiquidMesh
from coupling.interface import swept_gradient
from coupling.ports import AddedMass, Array


def wall_distance(mesh: LiquidMesh, geometry: CellGeometry) -> Array:
    """Distance (F,) [m] along the normal from a cell's centre to its face on the diaphragm."""
    patch = mesh.diaphragm
    area = geometry.face_area[patch]
    reach = geometry.face_centre[patch] - geometry.centre[mesh.owner[patch]]
    return np.asarray(np.einsum("fx,fx->f", reach, area) / np.linalg.norm(area, axis=1))


class NeumannLaplacian:
    """The Laplacian of the cells of ``mesh`` at ``geometry``, no flux through any wall, eliminated.

    One cell is held: pressures are defined up to a constant, which the callers' means remove.
    """

    def __init__(self, mesh: LiquidMesh, geometry: CellGeometry) -> None:
        self.mesh, self.geometry = mesh, geometry
        cells = eliminated(mesh)
        self._order, self._wall = cells.order, cells.wall
        # relax: with SuperLU's own merging of columns it takes twice as long here.
        matrix = cells.matrix(mesh, geometry)
        self._solver = splu(matrix, permc_spec="NATURAL", relax=1, **SYMMETRIC)
        assert np.array_equal(self._solver.perm_r, np.arange(len(self._order))), "a pivot has moved"

    def trace(self) -> Array:
        """G (F, F) [1/m]: p_f = -rho (G a)_f for accelerations a of the flux [m^3/s^2], Sum a = 0.

        p_f is the wall's value: the cell's, and the half cell beyond that ``zeroGradient`` omits.
        Symmetric; accelerations with a net flux are answered up to a constant.
        """
        # With the wall's cells last, what is left of the others' elimination is the trace's
        # inverse: no pressure inside need be found.
        mesh, inner = self.mesh, len(self._order) - len(self._wall)
        lower, upper = (part[inner:, inner:].toarray() for part in (self._solver.L, self._solver.U))
        face = np.searchsorted(self._wall, mesh.owner[mesh.diaphragm])
        trace = np.linalg.inv(lower @ upper)[np.ix_(face, face)]
        patch_area = np.linalg.norm(self.geometry.face_area[mesh.diaphragm], axis=1)
        return 0.5 * (trace + trace.T) + np.diag(wall_distance(mesh, self.geometry) / patch_area)

    def pressure(self, rate: Array) -> Array:
        """p/rho (c,) [m^2/s^2] in the cells that fluxes changing by ``rate`` ask for.

        ``rate`` (B,) [m^3/s^2], one for each boundary face, without a sum.
        """
        outward = np.bincount(self.mesh.owner[self.mesh.inner_faces :], rate, self.mesh.cells)
        pressure = np.zeros(self.mesh.cells)
        pressure[self._order] = self._solver.solve(-outward[self._order])
        return pressure


def added_mass(laplacian: NeumannLaplacian, patch: Array, density: float) -> AddedMass:
    """The liquid's inertia on the diaphragm's points ``patch`` (p, 3), where the cells are.

    Means over the interface are removed on both sides: a uniform pressure is the volume
    constraint's business. ``density`` [kg/m^3]. Exact factor of the discrete operator to rounding.
    """
    mesh, geometry = laplacian.mesh, laplacian.geometry
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    operator = density * mean @ laplacian.trace() @ mean.T
    value, vector = np.linalg.eigh(0.5 * (operator + operator.T))
    kept = value > 1e-12 * value[-1]
    factor = (vector[:, kept] * np.sqrt(value[kept])).T  # (r, F)
    gradient = swept_gradient(patch[mesh.patch_faces])  # (F, 4, 3)
    flux = np.zeros((len(area), len(patch), 3))
    np.add.at(flux, (np.arange(len(area))[:, None], mesh.patch_faces), gradient)
    return AddedMass(rows=np.tensordot(factor, flux, axes=1), factor=factor)
