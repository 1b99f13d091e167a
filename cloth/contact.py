"""Where the diaphragm lies on the rigid shell, and how far it slides there."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools


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


def stuck(start: Array, place: Array, limit: Array, rub: Array) -> Bools:
    """Nodes (n,) that the force ``rub`` (n, 3) [N] along the shell holds where they were.

    ``place`` (n, 3) [m] on the shell, where the ray through ``start`` (n, 3) [m] meets it, to
    rounding.
    """
    distance = np.maximum(np.linalg.norm(start, axis=1), 1e-30)
    finite = np.where(np.isfinite(limit), limit, 0.0)
    before = start * (finite / distance)[:, None]
    there = np.abs(place - before).max(axis=1) <= 1e-12 * finite
    return np.asarray(there & rub.any(axis=1))
