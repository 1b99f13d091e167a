"""Where the liquid's points on the shell stand: on arcs from the pool's middle to its rim."""

from __future__ import annotations

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh, shell_shares
from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints


class ShellArcs:
    """Places the shell's points of ``mesh``; ``rim`` (r,) are its ``patch_points`` on the rim.

    ``rim`` is ordered by the azimuths (r,) in the half ball, ``rim_azimuth``.
    """

    def __init__(self, mesh: LiquidMesh, rim: Ints, rim_azimuth: Array) -> None:
        wall = mesh.points[mesh.shell_points]
        self._reach = np.arccos(np.clip(-wall[:, 2], -1.0, 1.0)) / (0.5 * np.pi)
        self._azimuth = np.arctan2(wall[:, 1], wall[:, 0])
        self._rim_azimuth = rim_azimuth
        self.below = below_rim(mesh)[rim]

    def directions(self, middle: Array, rim: Array) -> Array:
        """Return the directions of the shell's points, on arcs from the pool's middle to its rim.

        Parameters
        ----------
        middle
            Vector towards the pool's middle (3,), of any length.
        rim
            Unit vectors to the points on the rim (r, 3), ordered as the mesh's.

        Returns
        -------
        Array
            Unit vectors (s, 3).
        """
        azimuth = self._rim_azimuth
        turn = np.concatenate([azimuth[-1:] - 2 * np.pi, azimuth, azimuth[:1] + 2 * np.pi])
        closed = np.concatenate([rim[-1:], rim, rim[:1]])
        end = np.stack([np.interp(self._azimuth, turn, closed[:, k]) for k in range(3)], 1)
        end /= np.linalg.norm(end, axis=1)[:, None]
        middle = middle / np.linalg.norm(middle)
        arc = np.arccos(np.clip(end @ middle, -1.0, 1.0))
        reach, arc = shell_shares(self._reach, arc)[:, None], arc[:, None]
        wall = np.sin((1.0 - reach) * arc) * middle + np.sin(reach * arc) * end
        return np.asarray(wall / np.sin(arc))


def pool_middle(rim: Array) -> Array:
    """Return the direction (3,) opposite the middle of the gas, which the shell's arcs start from.

    Against the vector area of the rim's loop: the gas' part of a shell that sees little of it
    always holds the other end, however the liquid's centre of gravity lies.

    ``rim`` (r, 3): unit vectors to its points, counter-clockwise seen from the gas.
    """
    return -np.asarray(cross(rim, np.roll(rim, -1, axis=0)).sum(axis=0))


def below_rim(mesh: LiquidMesh) -> Ints:
    """For every one of ``mesh.patch_points`` on the rim the shell's point, in the numbering of
    ``mesh.shell_points``, that an edge joins to it; -1 for the others."""
    ends = np.concatenate([mesh.edges, mesh.edges[:, ::-1]])
    rim = mesh.patch_points[mesh.rim]
    ends = ends[np.isin(ends[:, 0], rim) & np.isin(ends[:, 1], mesh.shell_points)]
    below = np.full(len(mesh.patch_points), -1)
    below[np.searchsorted(mesh.patch_points, ends[:, 0])] = np.searchsorted(
        mesh.shell_points, ends[:, 1]
    )
    return below
