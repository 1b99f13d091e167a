"""The liquid's added mass, by the finite-volume Neumann Laplacian of the flow's own mesh.

The operator answers what OpenFOAM answers to an acceleration of the diaphragm from rest: the same
cells, the same face coefficients (the orthogonal part of ``Gauss linear corrected``), the same wall
pressure. A coupling scheme that takes it into the structure's inertia therefore has little left to
iterate; an under-estimate of any short wave would diverge.
"""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from coupling.foam.geometry import CellGeometry
from coupling.foam.mesh import LiquidMesh
from coupling.interface import swept_gradient
from coupling.ports import Array


def wall_distance(mesh: LiquidMesh, geometry: CellGeometry) -> Array:
    """Distance (F,) [m] along the normal from a cell's centre to its face on the diaphragm."""
    patch = mesh.diaphragm
    area = geometry.face_area[patch]
    reach = geometry.face_centre[patch] - geometry.centre[mesh.owner[patch]]
    return np.asarray(np.einsum("fx,fx->f", reach, area) / np.linalg.norm(area, axis=1))


def neumann_trace(mesh: LiquidMesh, geometry: CellGeometry) -> Array:
    """G (F, F) [1/m]: p_f = -rho (G a)_f for accelerations a of the flux [m^3/s^2], Sum a = 0.

    p_f is the wall's value: the cell's, and the half cell beyond it that ``zeroGradient`` omits.
    Symmetric; accelerations with a net flux are answered up to a constant.
    """
    inner = mesh.inner_faces
    owner, neighbour = mesh.owner[:inner], mesh.neighbour
    area = geometry.face_area[:inner]
    reach = geometry.centre[neighbour] - geometry.centre[owner]
    # Over-relaxed: |S|^2 / (S.d), OpenFOAM's nonOrthDeltaCoeffs |S|, bounded as there.
    size = np.linalg.norm(area, axis=1)
    along = np.maximum(
        np.einsum("fx,fx->f", area, reach) / size, 0.05 * np.linalg.norm(reach, axis=1)
    )
    weight = size / along
    rows = np.r_[owner, neighbour, owner, neighbour]
    columns = np.r_[neighbour, owner, owner, neighbour]
    values = np.r_[-weight, -weight, weight, weight]
    laplacian = coo_array((values, (rows, columns)), shape=(mesh.cells,) * 2).tocsc()
    # Cell 0 is held: the trace is defined up to a constant, which the caller's means remove.
    solver = splu(csc_array(laplacian[1:, 1:]), permc_spec="MMD_AT_PLUS_A",
                  options={"SymmetricMode": True}, diag_pivot_thresh=0.0)  # fmt: skip
    wall = mesh.owner[mesh.diaphragm]
    source = np.zeros((mesh.cells, len(wall)))
    source[wall, np.arange(len(wall))] = 1.0
    pressure = np.zeros_like(source)
    pressure[1:] = solver.solve(source[1:])
    trace = pressure[wall]
    patch_area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    return 0.5 * (trace + trace.T) + np.diag(wall_distance(mesh, geometry) / patch_area)


def added_mass_rows(
    mesh: LiquidMesh, geometry: CellGeometry, patch: Array, density: float
) -> Array:
    """Rows B (r, p, 3) [kg^(1/2)] with M_a = B^T B on the diaphragm's points ``patch`` (p, 3).

    Means over the interface are removed on both sides: a uniform pressure is the volume
    constraint's business. ``density`` [kg/m^3]. Exact factor of the discrete operator to rounding.
    """
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    operator = density * mean @ neumann_trace(mesh, geometry) @ mean.T
    value, vector = np.linalg.eigh(0.5 * (operator + operator.T))
    kept = value > 1e-12 * value[-1]
    factor = (vector[:, kept] * np.sqrt(value[kept])).T  # (r, F)
    gradient = swept_gradient(patch[mesh.patch_faces])  # (F, 4, 3)
    flux = np.zeros((len(area), len(patch), 3))
    np.add.at(flux, (np.arange(len(area))[:, None], mesh.patch_faces), gradient)
    return np.tensordot(factor, flux, axes=1)
