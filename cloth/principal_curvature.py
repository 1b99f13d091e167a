"""The principal curvatures of the sheet at its nodes, in its moulded metric."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.curvature import curvature_of
from cloth.kernels import volume_and_gradient
from cloth.mesh import Mesh, border_nodes


class PrincipalCurvature:
    """Finds the principal curvatures of positions of a sheet, moulded at ``reference`` (n, 3) [m].

    ``triangles`` (m, 3). As the bending energy has them (``cloth.curvature``): second derivatives
    in the moulded metric, along the normal. Of second order in the grid for a sheet that does not
    stretch; a strain e changes them by about 2 e.
    """

    def __init__(self, reference: Array, triangles: Ints) -> None:
        size = len(reference)
        free: Bools = np.ones(size, dtype=np.bool_)
        self._rows = curvature_of(
            Mesh(points=reference, triangles=triangles, fixed=~free, rim_distance=np.zeros(size))
        )
        self._triangles, self._free = triangles, free
        self.known = free.copy()
        self.known[border_nodes(triangles)] = False

    def __call__(self, position: Array) -> tuple[Array, Array]:
        """Return the larger and the smaller curvature (n,) [1/m] at ``position`` (n, 3) [m].

        Positive where the sheet is bent towards the side from which its triangles run
        counter-clockwise. 0 on the border, where nothing is ``known``.
        """
        normal = np.empty_like(position)
        volume_and_gradient(position, self._triangles, self._free, normal)
        length = np.linalg.norm(normal, axis=1)
        normal /= np.where(length > 0.0, length, 1.0)[:, None]
        rows = self._rows
        trace, difference, twist = (
            np.einsum("id,id->i", part @ position, normal)
            for part in (rows.trace, rows.difference, rows.twist)
        )
        spread = np.hypot(difference, twist)
        return 0.5 * (trace + spread), 0.5 * (trace - spread)
