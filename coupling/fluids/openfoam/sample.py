"""What a flow on a mesh is sampled with at a step's end."""

from __future__ import annotations

import numpy as np

from coupling.finite_volume.geometry import CellGeometry, centre_of_gravity
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.wall import WallFlow
from coupling.fluids.gauge import largest_rate
from coupling.ports import Array, FlowSample


def flow_sample(
    mesh: LiquidMesh,
    geometry: CellGeometry,
    *,
    density: float,
    velocity: Array,
    boundary_pressure: Array,
    walls: WallFlow,
    pressure_work: float,
    volume_error: float,
    continuity_error: float,
) -> FlowSample:
    """Return what is sampled of a flow on a mesh at a step's end.

    Parameters
    ----------
    mesh
        The mesh, of c cells and B faces on the walls, the diaphragm's F first.
    geometry
        Where its cells stand.
    density
        Density of the liquid [kg/m^3].
    velocity
        Velocity of the cells (c, 3) [m/s], in the tank's frame.
    boundary_pressure
        p* on all walls (B,) [Pa], the diaphragm's first, less its area mean there.
    walls
        Viscous stress on the diaphragm, and slip along all walls.
    pressure_work
        Work of p* on the diaphragm in the step [J].
    volume_error, continuity_error
        As in ``FlowSample`` [-].

    Returns
    -------
    FlowSample
        The sample, SI.
    """
    boundary = slice(mesh.inner_faces, None)
    face_pressure = boundary_pressure[: mesh.diaphragm_faces]
    force = boundary_pressure[:, None] * geometry.face_area[boundary]
    speed = np.linalg.norm(velocity, axis=1)
    wall_speed = speed[mesh.owner[mesh.diaphragm]]
    rate = face_pressure / density + 0.5 * wall_speed**2  # -dphi/dt
    volume = float(geometry.volume.sum())
    return FlowSample(
        face_pressure=face_pressure,
        kinetic_pressure=-0.5 * density * wall_speed**2,
        viscous_traction=walls.traction,
        wall_pressure_force=force.sum(axis=0),
        wall_pressure_moment=np.cross(geometry.face_centre[boundary], force).sum(axis=0),
        speed_max=float(speed.max()),
        dphi_dt_max=largest_rate(rate, np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)),
        kinetic_energy=0.5 * density * float(geometry.volume @ speed**2),
        wall_slip=walls.slip,
        pressure_work=pressure_work,
        volume=volume,
        volume_error=volume_error,
        liquid_cg=centre_of_gravity(geometry),
        continuity_error=continuity_error,
    )
