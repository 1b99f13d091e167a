"""Volumes, areas and swept volumes as OpenFOAM itself computes them (v1912 to v2606).

Sources: ``primitiveMeshFaceCentresAndAreas.C``, ``primitiveMeshCellCentresAndVols.C``,
``face.C`` (``sweptVol``, ``centre``), ``triangleI.H`` (``sweptVol``) of OpenFOAM v1912. In v2012
the first two became ``primitiveMeshTools.C``; up to v2606 the formulas are the same, from v2512 on
with another order of sums.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.finite_volume import kernels
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array


def face_centres_and_areas(corner: Array) -> tuple[Array, Array]:
    """Return centres (F, 3) [m] and area vectors (F, 3) [m^2] of ``corner`` (F, 4, 3) [m].

    The corners are those of quadrilaterals. The fan's apex is the mean of the corners; the centre
    weighs its triangles by the magnitudes of their areas.
    """
    centre, area = np.empty((len(corner), 3)), np.empty((len(corner), 3))
    kernels.fans(corner, centre, area)
    return centre, area


def swept_volumes(old: Array, new: Array) -> Array:
    """Return the volume that every quadrilateral sweeps, as OpenFOAM's ``face::sweptVol``.

    Exact to rounding for any motion of the fan's triangles along straight lines, the two diagonals
    of the sides averaged.

    Parameters
    ----------
    old
        Corners before the motion (F, 4, 3) [m].
    new
        Corners after the motion (F, 4, 3) [m].

    Returns
    -------
    Array
        Volumes (F,) [m^3], positive along the normal.
    """
    swept = np.empty(len(old))
    centres = face_centres_and_areas(old)[0], face_centres_and_areas(new)[0]
    kernels.sweeps(old, new, *centres, swept)
    return swept


def fan_volume(corner: Array) -> float:
    """Return the volume [m^3] of cones from the origin to quadrilaterals ``corner`` (F, 4, 3) [m].

    The base of a cone is the quadrilateral's fan of triangles. The change of the volume is the sum
    of ``swept_volumes`` to rounding where the surface's rim is at rest.
    """
    cones = np.empty(len(corner))
    kernels.cones(corner, face_centres_and_areas(corner)[0], cones)
    return float(cones.sum())


@dataclass(frozen=True, kw_only=True)
class CellGeometry:
    """Volumes and centres of the cells, centres and area vectors of the faces.

    ``volume`` (c,) [m^3], ``centre`` (c, 3) [m], ``face_centre`` (F, 3) [m], ``face_area`` (F, 3)
    [m^2].
    """

    volume: Array
    centre: Array
    face_centre: Array
    face_area: Array


def cell_geometry(mesh: LiquidMesh, points: Array) -> CellGeometry:
    """Return the cells of ``mesh`` at ``points`` (P, 3) [m], as OpenFOAM's pyramids give them.

    The pyramids' apex is the mean of the centres of a cell's faces.
    """
    face_centre, area = face_centres_and_areas(points[mesh.faces])
    volume, centre = np.empty(mesh.cells), np.empty((mesh.cells, 3))
    kernels.cells(mesh.owner, mesh.neighbour, face_centre, area, volume, centre)
    return CellGeometry(volume=volume, centre=centre, face_centre=face_centre, face_area=area)


def centre_of_gravity(geometry: CellGeometry) -> Array:
    """Return the centre of gravity (3,) [m] of a homogeneous liquid in the cells."""
    return np.asarray(geometry.volume @ geometry.centre / geometry.volume.sum())


def non_orthogonality(mesh: LiquidMesh, geometry: CellGeometry) -> Array:
    """Return the angles [deg] of inner faces' normals to the lines between their cells' centres."""
    inner = mesh.inner_faces
    reach = geometry.centre[mesh.neighbour] - geometry.centre[mesh.owner[:inner]]
    area = geometry.face_area[:inner]
    cosine = np.einsum("fx,fx->f", reach, area)
    cosine /= np.linalg.norm(reach, axis=1) * np.linalg.norm(area, axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))
