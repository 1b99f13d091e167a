"""What the flow does along its walls: the viscous stress there, and how well it is resolved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array


@dataclass(frozen=True, kw_only=True)
class WallFlow:
    """The flow at the walls at a step's end.

    ``traction`` (F,) [Pa]: size of the viscous stress on the diaphragm's faces; ``slip``
    [m^4/s^2]: int over all walls of the squared tangential speed of the cells beside them, relative
    to the wall.
    """

    traction: Array
    slip: float


def cell_distance(mesh: LiquidMesh, geometry: CellGeometry) -> float:
    """Distance [m] of the wall cells' centres from all walls, the mean over the walls' area."""
    _, distance = _normals(mesh, geometry)
    size = np.linalg.norm(geometry.face_area[mesh.inner_faces :], axis=1)
    return float(distance @ size / size.sum())


def _normals(mesh: LiquidMesh, geometry: CellGeometry) -> tuple[Array, Array]:
    """Outward normals (B, 3) of all walls, and their distances (B,) [m] from the cells' centres."""
    walls = slice(mesh.inner_faces, None)
    area = geometry.face_area[walls]
    normal = area / np.linalg.norm(area, axis=1)[:, None]
    reach = geometry.face_centre[walls] - geometry.centre[mesh.owner[walls]]
    return normal, np.einsum("fx,fx->f", reach, normal)


def wall_flow(
    mesh: LiquidMesh,
    start: CellGeometry,
    end: CellGeometry,
    velocity: Array,
    *,
    dt: float,
    viscosity: float,
) -> WallFlow:
    """Return the flow at the walls, of cells moving at ``velocity`` (c, 3) [m/s], at a step's end.

    The step takes ``dt`` [s]; ``start``, ``end``: the mesh then; the diaphragm moves as its faces'
    centres do, the shell is at rest. ``viscosity`` is the dynamic one [Pa s]. The stress mu (du + n
    n.du)/d takes the speed to fall evenly over the half cell d, as the solver does: where a
    boundary layer is thinner than d it is too small, by about the ratio of the two.
    """
    walls = slice(mesh.inner_faces, None)
    area, centre, cell = end.face_area[walls], end.face_centre[walls], mesh.owner[walls]
    size = np.linalg.norm(area, axis=1)
    normal, distance = _normals(mesh, end)
    wall = np.zeros_like(centre)
    count = mesh.diaphragm_faces
    wall[:count] = (centre[:count] - start.face_centre[walls][:count]) / dt
    relative = velocity[cell] - wall
    along = np.einsum("fx,fx->f", relative, normal)[:, None] * normal
    stress = viscosity * np.linalg.norm(relative + along, axis=1) / distance
    slip = np.sum((relative - along) ** 2, axis=1)
    return WallFlow(
        traction=stress[:count],
        slip=float(slip @ size),
    )
