"""Where the liquid lies below the diaphragm."""

from __future__ import annotations

import numpy as np

from coupling.finite_volume.swept import cross
from coupling.ports import Array, Ints, Shell


def liquid_cg(position: Array, triangles: Ints, shell: Shell, volume: float) -> Array:
    """Return the centre of gravity of the liquid below the diaphragm, exactly for its triangles.

    The liquid is the part of the shell below the rim and the cone from the diaphragm to the origin
    in the rim's plane. That both together have the given volume is not checked.

    Parameters
    ----------
    position
        Nodes of the diaphragm (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3), counter-clockwise seen from the gas.
    shell
        The shell.
    volume
        Volume of the liquid [m^3], of both parts together.

    Returns
    -------
    Array
        Centre of gravity (3,) [m] from the origin.
    """
    moment = cone_moment(position, triangles)
    moment[2] += shell.moment_below(0.0)
    return np.asarray(moment / volume)


def cone_moment(position: Array, triangles: Ints) -> Array:
    """Return int x dV (3,) [m^4] over the cone from the diaphragm to the origin.

    ``position`` (n, 3) [m] and ``triangles`` (m, 3) as above.
    """
    a, b, c = (position[triangles[:, k]] for k in range(3))
    cone = np.einsum("mx,mx->m", a, cross(b, c)) / 6.0
    return np.asarray(cone @ (a + b + c) / 4.0)


def volume_below(position: Array, triangles: Ints, shell: Shell) -> float:
    """Return the volume [m^3] below the diaphragm, exactly for its triangles.

    ``position`` (n, 3) [m], ``triangles`` (m, 3) and ``shell`` as above.
    """
    a, b, c = (position[triangles[:, k]] for k in range(3))
    return float(np.einsum("mx,mx->", a, cross(b, c)) / 6.0 + shell.volume_below(0.0))
