"""Where the liquid lies below the diaphragm."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints, Shell


def liquid_cg(position: Array, triangles: Ints, shell: Shell, volume: float) -> Array:
    """Centre of gravity (3,) [m] of the liquid below the diaphragm at ``position`` (n, 3) [m].

    The part of the ``shell`` below the rim and the cone from the diaphragm to the origin in the
    rim's plane, of ``volume`` [m^3] together. Exact for the triangles.
    """
    a, b, c = (position[triangles[:, k]] for k in range(3))
    cone = np.einsum("mx,mx->m", a, np.cross(b, c)) / 6.0
    moment = cone @ (a + b + c) / 4.0
    moment[2] += shell.moment_below(0.0)
    return np.asarray(moment / volume)
