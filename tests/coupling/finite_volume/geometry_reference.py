"""NumPy definitions of ``coupling.finite_volume.kernels``, named as in its ``geometry``."""

import numpy as np

from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.swept import cross


def face_centres_and_areas(corner):
    """Centres (F, 3) [m] and area vectors (F, 3) [m^2] of quadrilaterals ``corner`` (F, 4, 3).

    The fan's apex is the mean of the corners; the centre weighs its triangles by the magnitudes of
    their areas, as v1912 does (later versions by their parts along the face's normal).
    """
    middle = corner.mean(axis=1, keepdims=True)
    following = np.roll(corner, -1, axis=1)
    normal = cross(following - corner, middle - corner)
    weight = np.linalg.norm(normal, axis=2)
    triple = corner + following + middle
    centre = np.einsum("fk,fkx->fx", weight, triple) / (3 * weight.sum(axis=1)[:, None] + 1e-300)
    return centre, 0.5 * normal.sum(axis=1)


def swept_volumes(old, new):
    """Volume (F,) [m^3] that every quadrilateral sweeps from ``old`` to ``new`` (F, 4, 3).

    Positive along the normal; ``face::sweptVol``. Exact to rounding for any motion of the fan's
    triangles along straight lines, the two diagonals of the sides averaged.
    """
    centre_old, centre_new = (face_centres_and_areas(c)[0][:, None] for c in (old, new))
    a, b = old, np.roll(old, -1, axis=1)
    ta, tb = new, np.roll(new, -1, axis=1)
    c = np.broadcast_to(centre_old, a.shape)
    tc = np.broadcast_to(centre_new, a.shape)

    def volume(edge, one, two):
        return np.asarray(np.einsum("fkx,fkx->fk", edge, cross(one, two)))

    # Triangles run (centre, this corner, next corner), as in face.C.
    p, q, r, tp, tq, tr = c, a, b, tc, ta, tb
    total = (
        2 * volume(tp - p, q - p, r - p)
        + volume(tq - q, r - q, tp - q)
        + volume(r - tr, tq - tr, tp - tr)
        + volume(q - tq, tp - tq, tr - tq)
        + volume(r - tr, q - tr, tp - tr)
    )
    return np.asarray(total.sum(axis=1) / 12.0)


def fan_volume(corner):
    """Cone from the origin to the fans of quadrilaterals ``corner`` (F, 4, 3) [m^3].

    Its change is the sum of ``swept_volumes`` to rounding where the surface's rim is at rest.
    """
    centre = face_centres_and_areas(corner)[0][:, None]
    following = np.roll(corner, -1, axis=1)
    return float(np.einsum("fkx,fkx->", np.broadcast_to(centre, corner.shape),
                           cross(corner, following)) / 6.0)  # fmt: skip


def cell_geometry(mesh, points):
    """Cells of ``mesh`` at ``points`` (P, 3) [m], by OpenFOAM's pyramids about a mean centre."""
    face_centre, area = face_centres_and_areas(points[mesh.faces])
    estimate = _gather(mesh, face_centre, face_centre[: mesh.inner_faces]) / 6.0
    volume, moment = np.zeros(mesh.cells), np.zeros((mesh.cells, 3))
    for cell, faces, sign in _sides(mesh):
        reach = face_centre[faces] - estimate[cell]
        pyramid = sign * np.einsum("fx,fx->f", area[faces], reach) / 3.0
        np.add.at(volume, cell, pyramid)
        np.add.at(moment, cell, pyramid[:, None] * (0.75 * reach + estimate[cell]))
    return CellGeometry(
        volume=volume, centre=moment / volume[:, None], face_centre=face_centre, face_area=area
    )


def _sides(mesh):
    """Faces as their owner sees them and as their neighbour does."""
    return (mesh.owner, slice(None), 1.0), (mesh.neighbour, slice(mesh.inner_faces), -1.0)


def _gather(mesh, owner_value, neighbour_value):
    total = np.zeros((mesh.cells, 3))
    np.add.at(total, mesh.owner, owner_value)
    np.add.at(total, mesh.neighbour, neighbour_value)
    return total
