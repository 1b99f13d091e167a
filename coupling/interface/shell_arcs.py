"""Where the liquid's points on the shell stand: on arcs from the pool's middle to its rim."""

from __future__ import annotations

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh, shell_shares
from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints, OnRays

# Places of a long arc at which its length is known, between which it is linear: 17 move omega^2 of
# a pill's lowest wave by 1e-4, 257 by 3e-6.
EVEN = 65


class ShellArcs:
    """Places the shell's points of ``mesh``; ``rim`` (r,) are its ``patch_points`` on the rim.

    ``rim`` is ordered by the azimuths (r,) in the half ball, ``rim_azimuth``.
    """

    def __init__(self, mesh: LiquidMesh, rim: Ints, rim_azimuth: Array) -> None:
        wall = mesh.points[mesh.shell_points]
        self._length = 0.0 if mesh.divisions is None else mesh.divisions.length
        self._reach = _reach(wall[:, 2], self._length)
        self._azimuth = np.arctan2(wall[:, 1], wall[:, 0])
        self._rim_azimuth = rim_azimuth
        self.below = below_rim(mesh)[rim]

    def points(self, shell: OnRays, middle: Array, rim: Array) -> Array:
        """Return the shell's points, on arcs from the pool's middle to its rim.

        Even shares of an arc's angle, as a ball's points have; of its length below a long liquid,
        whose wall even angles would cut into facets of very different lengths.

        Parameters
        ----------
        shell
            What they stand on.
        middle
            Vector towards the pool's middle (3,), of any length.
        rim
            Unit vectors to the points on the rim (r, 3), ordered as the mesh's.

        Returns
        -------
        Array
            Points (s, 3) [m].
        """
        middle = middle / np.linalg.norm(middle)
        end = self._around(rim)
        end /= np.linalg.norm(end, axis=1)[:, None]
        arc = np.arccos(np.clip(end @ middle, -1.0, 1.0))
        if self._length > 0.0:
            reach = self._by_length(shell, middle, rim)
        else:
            reach = shell_shares(self._reach, arc)
        return shell.on_rays(_on_arcs(middle, end, arc, reach))

    def _around(self, values: Array) -> Array:
        """Values (s, k) at the points' azimuths, of ``values`` (r, k) on the rim."""
        azimuth = self._rim_azimuth
        turn = np.concatenate([azimuth[-1:] - 2 * np.pi, azimuth, azimuth[:1] + 2 * np.pi])
        closed = np.concatenate([values[-1:], values, values[:1]])
        columns = range(values.shape[1])
        return np.stack([np.interp(self._azimuth, turn, closed[:, k]) for k in columns], 1)

    def _by_length(self, shell: OnRays, middle: Array, rim: Array) -> Array:
        """Shares (s,) of the arcs' angles at which the points stand, by the arcs' lengths."""
        arc = np.arccos(np.clip(rim @ middle, -1.0, 1.0))
        even = np.linspace(0.0, 1.0, EVEN)
        ways = [_on_arcs(middle, rim, arc, np.full(len(rim), share)) for share in even]
        places = shell.on_rays(np.concatenate(ways)).reshape(EVEN, -1, 3)
        steps = np.linalg.norm(np.diff(places, axis=0), axis=2)
        lengths = np.concatenate([np.zeros((1, len(rim))), np.cumsum(steps, axis=0)])
        width = np.linalg.norm(places[-1], axis=1) * np.sin(arc)
        room = (0.5 * np.pi + self._length) * width / lengths[-1]
        shares = shell_shares(self._reach, 0.0, self._around(room[:, None])[:, 0])
        angles = [np.interp(even, own / own[-1], even) for own in lengths.T]
        table = self._around(np.array(angles))  # (s, EVEN), of even shares of the length
        lower = np.minimum((shares * (EVEN - 1)).astype(int), EVEN - 2)
        beyond, at = shares * (EVEN - 1) - lower, np.arange(len(shares))
        return np.asarray((1.0 - beyond) * table[at, lower] + beyond * table[at, lower + 1])


def _on_arcs(middle: Array, end: Array, arc: Array, share: Array) -> Array:
    """Unit vectors (n, 3) at shares (n,) of arcs (n,) [rad] from ``middle`` (3,) to ``end``."""
    arc, share = arc[:, None], share[:, None]
    wall = np.sin((1.0 - share) * arc) * middle + np.sin(share * arc) * end
    return np.asarray(wall / np.sin(arc))


def _reach(height: Array, length: float) -> Array:
    """Shares (s,) of the way along the half ball's wall from its bottom to the disc.

    ``height`` (s,) of the points over R; ``length``: of the half ball's cylinder.
    """
    above = np.maximum(height + length, 0.0) if length > 0.0 else 0.0
    arc = np.arccos(np.clip(-height - length, -1.0, 1.0))
    return np.asarray((np.minimum(arc, 0.5 * np.pi) + above) / (0.5 * np.pi + length))


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
