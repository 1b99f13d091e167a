"""How far the nodes of a sheet are beyond where it rests on the shell."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints, Shell

_FILM = 1e-2  # see ``ContactDistance.of``
_FLAT = 1e-6  # squared sine of a triangle's corner below which it counts as that wide


class ContactDistance:
    """Distances along a sheet of ``triangles`` (m, 3) from where it leaves the ``shell``."""

    def __init__(self, triangles: Ints, shell: Shell) -> None:
        self._triangles, self._shell = triangles, shell

    def of(self, position: Array) -> Array:
        """Return how far every node is beyond contact, in mean edges of the sheet.

        By its gap over the gap's steepest slope in a triangle at the node: the distance where the
        sheet turns off the shell at a corner, half of it and less where it leaves straight along
        the tangent. A film of even thickness, which has no slope, is contact where it is thinner
        than a hundredth of h^2/(2 R), h the mean edge and R the shell's size: the gap of a straight
        sheet one edge on.

        Parameters
        ----------
        position
            Nodes (n, 3) [m].

        Returns
        -------
        Array
            Distances (n,) [-], 0 at nodes on the shell.
        """
        gap = np.maximum(self._shell.gap(position), 0.0)
        values, corner = gap[self._triangles], position[self._triangles]
        u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
        du, dv = values[:, 1] - values[:, 0], values[:, 2] - values[:, 0]
        uu, uv, vv = (np.einsum("mx,mx->m", a, b) for a, b in ((u, u), (u, v), (v, v)))
        area = np.maximum(uu * vv - uv * uv, _FLAT * uu * vv)  # twice it, squared
        steep = np.sqrt(np.maximum(du * du * vv - 2.0 * du * dv * uv + dv * dv * uu, 0.0) / area)
        edge = float(np.sqrt(uu).mean())
        slope = np.full(len(gap), _FILM * 0.5 * edge / self._shell.size)
        np.maximum.at(slope, self._triangles, steep[:, None])
        return np.asarray(gap / slope / edge)
