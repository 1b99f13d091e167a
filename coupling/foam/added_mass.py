"""The liquid's added mass, by the finite-volume Neumann Laplacian of the flow's own mesh.

The operator answers what OpenFOAM answers to an acceleration of the diaphragm from rest: the same
cells, the same face coefficients (``Gauss linear corrected``), the same wall pressure. A coupling
scheme that takes it into the structure's inertia therefore has little left to iterate; an
under-estimate of any short wave would diverge.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from coupling.foam.geometry import CellGeometry
from coupling.foam.mesh import LiquidMesh
from coupling.interface import swept_gradient
from coupling.ports import AddedMass, Array, Ints


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
        self._order, self._wall = _elimination(
            mesh.owner.tobytes(), mesh.neighbour.tobytes(), mesh.diaphragm.stop
        )
        matrix = _laplacian(mesh, geometry)[self._order][:, self._order]
        self._solver = splu(csc_array(matrix), **_ORDERED)
        assert np.array_equal(self._solver.perm_r, np.arange(len(self._order))), "a pivot has moved"

    def trace(self) -> Array:
        """G (F, F) [1/m]: p_f = -rho (G a)_f for accelerations a of the flux [m^3/s^2], Sum a = 0.

        p_f is the wall's value: the cell's, and the half cell beyond that ``zeroGradient`` omits.
        Symmetric; accelerations with a net flux are answered up to a constant.
        """
        # With the wall's cells last, what is left of the others' elimination is the trace's
        # inverse: no pressure inside need be found.
        mesh, inner = self.mesh, len(self._order) - len(self._wall)
        schur = (self._solver.L[inner:, inner:] @ self._solver.U[inner:, inner:]).toarray()
        face = np.searchsorted(self._wall, mesh.owner[mesh.diaphragm])
        trace = np.linalg.inv(schur)[np.ix_(face, face)]
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


_SYMMETRIC: dict[str, Any] = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
_ORDERED: dict[str, Any] = {"permc_spec": "NATURAL", **_SYMMETRIC}


@lru_cache(maxsize=4)
def _elimination(owner: bytes, neighbour: bytes, stop: int) -> tuple[Ints, Ints]:
    """Cells but the first inner one, ordered for little fill with the wall's last; and the wall's.

    ``owner``, ``neighbour``: the mesh's, as bytes; ``stop``: where the wall's faces end.
    """
    owners, neighbours = np.frombuffer(owner, np.int64), np.frombuffer(neighbour, np.int64)
    wall, cells = np.unique(owners[len(neighbours) : stop]), int(owners.max()) + 1
    inner = np.setdiff1d(np.arange(cells), wall)[1:]
    faces, shape = np.arange(len(neighbours)), (len(neighbours), cells)
    sides = _sparse(faces, owners[: len(neighbours)], 1.0, shape)
    sides = sides + _sparse(faces, neighbours, 1.0, shape)
    near = csc_array(sides.T @ sides)
    pattern = csc_array((near @ near)[inner][:, inner])  # of the corrected Laplacian
    pattern.setdiag(2.0 * pattern.sum(axis=0))
    found = splu(csc_array(pattern), permc_spec="MMD_AT_PLUS_A", **_SYMMETRIC)
    return np.concatenate([inner[np.argsort(found.perm_c)], wall]), wall


def _laplacian(mesh: LiquidMesh, geometry: CellGeometry) -> csc_array:
    """Outward flux of -grad p (c, c) of every cell: ``Gauss linear corrected``, over-relaxed."""
    inner = mesh.inner_faces
    owner, neighbour = mesh.owner[:inner], mesh.neighbour
    area = geometry.face_area[:inner]
    reach = geometry.centre[neighbour] - geometry.centre[owner]
    size = np.linalg.norm(area, axis=1)
    along = np.einsum("fx,fx->f", area, reach) / size
    along = np.maximum(along, 0.05 * np.linalg.norm(reach, axis=1))  # bounded as in OpenFOAM
    faces, shape = np.arange(inner), (inner, mesh.cells)
    difference = _sparse(faces, neighbour, 1.0, shape) - _sparse(faces, owner, 1.0, shape)
    to_owner = np.einsum("fx,fx->f", geometry.face_centre[:inner] - geometry.centre[owner], area)
    to_neighbour = np.einsum(
        "fx,fx->f", geometry.centre[neighbour] - geometry.face_centre[:inner], area
    )
    weight = np.abs(to_neighbour) / (np.abs(to_owner) + np.abs(to_neighbour))
    mean = _sparse(faces, owner, weight, shape) + _sparse(faces, neighbour, 1 - weight, shape)
    flux = csc_array(difference.multiply((size / along)[:, None]))
    boundary = _sparse(np.arange(len(mesh.owner) - inner), mesh.owner[inner:], 1.0,
                       (len(mesh.owner) - inner, mesh.cells))  # fmt: skip
    for axis in range(3):
        outward = difference.T.multiply(-area[:, axis]) @ mean
        outward += boundary.T.multiply(geometry.face_area[inner:, axis]) @ boundary
        gradient = outward.multiply((1 / geometry.volume)[:, None])
        slant = area[:, axis] - (size / along) * reach[:, axis]
        flux = flux + (mean @ gradient).multiply(slant[:, None])
    return csc_array(difference.T @ flux)


def _sparse(rows: Ints, columns: Ints, values: Array | float, shape: tuple[int, int]) -> csc_array:
    data = np.broadcast_to(np.asarray(values, dtype=float), rows.shape)
    return csc_array(coo_array((data, (rows, columns)), shape=shape))


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
