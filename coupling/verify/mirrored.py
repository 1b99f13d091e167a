"""A cloth that is held to the mirror symmetry of its mesh."""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.spatial import cKDTree

from cloth.arrays import Array, Ints
from cloth.mesh import Mesh
from cloth.step import Cloth

MIRROR = np.diag([1.0, -1.0, 1.0])
MATCH = 1e-9  # of the mesh's extent: how near an image must come to a node


class MirroredCloth(Cloth):
    """A ``Cloth`` whose every step is averaged with its mirror image in y = 0.

    For shapes that would lose this symmetry by themselves: a cylindrical sheet full of liquid,
    with free edges, rolls over, because the deeper edge is pressed harder. Raises ValueError for
    a mesh that is not its own image. Contact forces are not averaged.
    """

    def __init__(self, *, mesh: Mesh, **options: Any) -> None:
        super().__init__(mesh=mesh, **options)
        corners = mesh.points[mesh.triangles]
        reach = MATCH * float(np.ptp(mesh.points, axis=0).max())
        self._nodes = _images(mesh.points, reach)
        self._images = _images(corners.mean(axis=1), reach)
        self._frames = _frames(corners)

    def accept_step(self) -> None:
        """Commit the average of the last solve and its image."""
        super().accept_step()
        saved = self.save()
        for name in ("position", "velocity"):
            saved[name] = 0.5 * (saved[name] + saved[name][self._nodes] @ MIRROR)
        # The tension's columns belong to each triangle's own axes: first to those of the mesh.
        tension = saved["tension"] @ self._frames.transpose(0, 2, 1)
        tension = 0.5 * (tension + MIRROR @ tension[self._images] @ MIRROR)
        saved["tension"] = tension @ self._frames
        self.restore(saved)


def _images(points: Array, reach: float) -> Ints:
    """Index (n,) of every point's mirror image among ``points`` (n, 3)."""
    distance, index = cKDTree(points).query(points @ MIRROR)
    if np.max(distance) > reach:
        raise ValueError("mirrored cloth: the mesh must be its own mirror image in y = 0.")
    return np.asarray(index, dtype=np.int64)


def _frames(corners: Array) -> Array:
    """Axes (m, 3, 2) of triangles (m, 3, 3), as ``cloth.mesh.rest_gradients`` lays them."""
    first = corners[:, 1] - corners[:, 0]
    first = first / np.linalg.norm(first, axis=1)[:, None]
    normal = np.cross(first, corners[:, 2] - corners[:, 0])
    normal = normal / np.linalg.norm(normal, axis=1)[:, None]
    return np.stack([first, np.cross(normal, first)], axis=2)
