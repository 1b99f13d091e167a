"""How the walls move, as far as the liquid follows: without what their points slide along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.mesh_shape import MeshShape
from coupling.finite_volume.swept import level_shift, swept_gradient
from coupling.ports import Array, InterfaceMotion, Turn

# Share of the liquid's volume in a step. A slide of less is rounding, and none: a flow at rest has
# nothing that would take up the rounding of a sum of fluxes.
NO_SLIDE = 1e-10


@dataclass(frozen=True, kw_only=True)
class WallMotion:
    """The walls at a step's end.

    ``flux`` (F,) [m^3/s] that the diaphragm's faces drive, ``rate`` (F,) [m^3/s^2] at which it
    changes; ``velocity`` (F, 3) [m/s] of the diaphragm at the faces' centres. ``slide`` (B, 3)
    [m/s]: what the points of the boundary faces move more than the walls do.
    """

    flux: Array
    rate: Array
    velocity: Array
    slide: Array


def wall_motion(
    mesh: LiquidMesh,
    before: MeshShape,
    now: MeshShape,
    motion: InterfaceMotion | None,
    *,
    turn: Turn | None = None,
    dt: float,
    swept: Array,
    rate: Array,
    least: float,
) -> WallMotion:
    """Return how the walls move in a step of ``dt`` [s].

    Parameters
    ----------
    mesh
        The mesh, with B faces on the walls, the diaphragm's F first.
    before, now
        Where it stands at the step's start and end.
    motion
        How the diaphragm moves at the points of the patch, None where they move as it does.
    turn
        How the shell turns, None where it does not.
    swept, rate
        Flux of the boundary faces (B,) [m^3/s] that the points' motion makes, as the solver's time
        scheme has it, and its rate of change (B,) [m^3/s^2].
    least
        Volume swept a second [m^3/s] below which a slide is none.

    Returns
    -------
    WallMotion
        The walls' motion.
    """
    of_points = centre_velocity(mesh, before, now, dt)
    if motion is not None:
        return sliding_walls(
            mesh, now, motion, of_points=of_points, swept=swept, least=least, turn=turn
        )
    count = mesh.diaphragm_faces
    return WallMotion(
        flux=swept[:count], rate=rate[:count], velocity=of_points[:count],
        slide=np.zeros_like(of_points),
    )  # fmt: skip


def centre_velocity(mesh: LiquidMesh, before: MeshShape, now: MeshShape, dt: float) -> Array:
    """Velocity (B, 3) [m/s] of the boundary faces' centres over a step of ``dt`` [s]."""
    walls = slice(mesh.inner_faces, None)
    moved = now.geometry.face_centre[walls] - before.geometry.face_centre[walls]
    return np.asarray(moved / dt)


def sliding_walls(
    mesh: LiquidMesh,
    now: MeshShape,
    motion: InterfaceMotion,
    *,
    of_points: Array,
    swept: Array,
    least: float,
    turn: Turn | None = None,
) -> WallMotion:
    """Return how the walls move whose points slide along them.

    The fluxes are those of the sheet's own velocity at the step's end, the gradient of the swept
    volumes times that of the points: the transpose of the forces, so that the work is the same on
    both sides. What they miss of a closed volume is of second order in the step, and taken off as
    an even rise.

    Parameters
    ----------
    mesh
        The mesh, with B faces on the walls, the diaphragm's F first.
    now
        Where it stands at the step's end.
    motion
        How the points of its patch move.
    of_points
        Velocity of the boundary faces' centres (B, 3) [m/s] that the points' motion makes.
    swept
        Flux of the boundary faces (B,) [m^3/s] that it makes, as the solver's time scheme has it.
    least
        Volume swept a second [m^3/s] below which a slide is none.
    turn
        How the shell turns, None where it does not.

    Returns
    -------
    WallMotion
        The walls' motion.
    """
    count, corners = mesh.diaphragm_faces, mesh.faces[mesh.inner_faces :]
    gradient = swept_gradient(now.points[corners])
    velocity = np.zeros_like(now.points) if turn is None else turn.velocity(now.points)
    velocity[mesh.patch_points] = motion.velocity(now.patch)
    height, area = level_shift(now.patch, mesh.patch_faces, mesh.rim)
    for _ in range(2):  # the second takes off what rounding has left
        flux = np.einsum("fkx,fkx->f", gradient, velocity[corners])
        velocity[mesh.patch_points] -= height * (flux.sum() / area)
    flux = np.einsum("fkx,fkx->f", gradient, velocity[corners])
    normal = now.geometry.face_area[mesh.inner_faces :]
    size = np.linalg.norm(normal, axis=1)
    normal = normal / size[:, None]
    flux[:count] += (swept.sum() - flux.sum()) * size[:count] / size[:count].sum()
    of_sheet = velocity[corners].mean(axis=1)
    slide = of_points - of_sheet
    through = (swept - flux) / size
    slide += (through - np.einsum("fx,fx->f", slide, normal))[:, None] * normal
    if np.abs(swept - flux).sum() < least:
        slide = np.zeros_like(slide)
    acceleration = motion.acceleration(now.patch)[mesh.patch_faces]
    return WallMotion(
        flux=flux[:count],
        rate=np.einsum("fkx,fkx->f", gradient[:count], acceleration),
        velocity=of_sheet[:count],
        slide=slide,
    )
