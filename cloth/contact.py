"""Where the diaphragm lies on the rigid shell, and how far it slides there."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools
from cloth.shell.shell import Shell

EXACT = 1e-12  # of the shell's size, within which a node is where it was


def pressed(position: Array, contact_force: Array, shell: Shell, reach: float) -> Bools:
    """Nodes (n,) within ``reach`` [m] of the ``shell`` whose ``contact_force`` points outward.

    ``contact_force`` (n, 3) [N] is what the sheet exerts on the shell (and on itself, elsewhere).
    """
    outward = np.einsum("id,id->i", contact_force, shell.normal(position))
    return np.asarray((shell.gap(position) < reach) & (outward > 0.0))


def slid(start: Array, end: Array, pressed: Bools, shell: Shell) -> Array:
    """Way (n,) [m] along the ``shell`` from ``start`` to ``end`` (n, 3) of nodes ``pressed`` on it.

    Of a straight motion: its part across the shell's normal at its middle.
    """
    normal, move = shell.normal(0.5 * (start + end)), end - start
    along = move - np.sum(move * normal, axis=1)[:, None] * normal
    return np.where(pressed, np.linalg.norm(along, axis=1), 0.0)


def stuck(start: Array, place: Array, shell: Shell, rub: Array) -> Bools:
    """Nodes (n,) that the force ``rub`` (n, 3) [N] along the ``shell`` holds where they were.

    ``place`` (n, 3) [m] on the shell, where it is nearest to ``start`` (n, 3) [m], to rounding.
    """
    there = np.abs(place - shell.project(start)).max(axis=1) <= EXACT * shell.size
    return np.asarray(there & rub.any(axis=1))
