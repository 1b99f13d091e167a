"""How near to the rigid shell the diaphragm may come."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Bools
from cloth.mesh import Mesh

WEDGE = math.tan(math.radians(15.0))


def shell_limits(mesh: Mesh, position: Array, radius: float | None, clearance: float) -> Array:
    """Largest |x_i| (n,) [m] allowed, at the present ``position`` (n, 3) [m].

    ``radius`` on the gas side (z >= 0). On the wet side a film is kept free for a body-fitted
    flow mesh: ``clearance`` [m] wide, narrowing to the rim as a wedge of 15 degrees, which bounds
    both the distance s from the rim along the moulded shape and the depth -z:
    radius - min(clearance, tan(15 deg) min(s, max(-z, 0))). So it is full from
    s0 = clearance / tan(15 deg) = 3.7 clearance on. Continuous in z, but only piecewise smooth.
    Infinite where ``radius`` is None.
    """
    if radius is None:
        return np.full(len(position), np.inf)
    if clearance <= 0.0:
        return np.full(len(position), radius)
    depth = np.minimum(mesh.rim_distance, np.maximum(-position[:, 2], 0.0))
    return np.asarray(radius - np.minimum(clearance, WEDGE * depth))


def pressed(position: Array, contact_force: Array, limit: Array, reach: float) -> Bools:
    """Nodes (n,) within ``reach`` [m] of their ``limit`` whose ``contact_force`` points outward.

    ``contact_force`` (n, 3) [N] is what the sheet exerts on the shell (and on itself, elsewhere).
    """
    gap = limit - np.linalg.norm(position, axis=1)
    outward = np.einsum("id,id->i", contact_force, position)
    return np.asarray((gap < reach) & (outward > 0.0))


def slid(start: Array, end: Array, pressed: Bools) -> Array:
    """Way (n,) [m] along the shell from ``start`` to ``end`` (n, 3) of the nodes ``pressed`` on it.

    Of a straight motion: its part across the radius of its middle.
    """
    middle = 0.5 * (start + end)
    radius = np.maximum(np.linalg.norm(middle, axis=1), 1e-30)[:, None]
    move = end - start
    outward = np.sum(move * middle / radius, axis=1)[:, None] * middle / radius
    return np.where(pressed, np.linalg.norm(move - outward, axis=1), 0.0)


def clamp_to_shell(position: Array, limit: Array) -> Array:
    """``position`` (n, 3) with every node moved radially to its ``limit`` (n,) if beyond it."""
    distance = np.linalg.norm(position, axis=1)
    return np.asarray(position * np.minimum(1.0, limit / np.maximum(distance, 1e-30))[:, None])
