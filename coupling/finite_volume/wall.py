"""What the flow does along its walls: the viscous stress there, and how well it is resolved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array, Turn


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
    geometry: CellGeometry,
    velocity: Array,
    diaphragm: Array,
    *,
    viscosity: float,
    turn: Turn | None = None,
) -> WallFlow:
    """Return the flow at the walls.

    The stress mu (du + n n.du)/d takes the speed to fall evenly over the half cell d, as the
    solver does: where a boundary layer is thinner than d it is too small, by about the ratio of
    the two.

    Parameters
    ----------
    mesh, geometry
        The mesh, and where its cells stand.
    velocity
        Velocity of the cells (c, 3) [m/s].
    diaphragm
        Velocity of the diaphragm at the centres of its faces (F, 3) [m/s].
    viscosity
        Dynamic viscosity [Pa s].
    turn
        How the shell turns, None where it is at rest.

    Returns
    -------
    WallFlow
        Stress and slip.
    """
    walls = slice(mesh.inner_faces, None)
    area, cell = geometry.face_area[walls], mesh.owner[walls]
    size = np.linalg.norm(area, axis=1)
    normal, distance = _normals(mesh, geometry)
    wall = np.zeros_like(area) if turn is None else turn.velocity(geometry.face_centre[walls])
    count = mesh.diaphragm_faces
    wall[:count] = diaphragm
    relative = velocity[cell] - wall
    along = np.einsum("fx,fx->f", relative, normal)[:, None] * normal
    stress = viscosity * np.linalg.norm(relative + along, axis=1) / distance
    slip = np.sum((relative - along) ** 2, axis=1)
    return WallFlow(
        traction=stress[:count],
        slip=float(slip @ size),
    )
