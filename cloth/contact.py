"""Where the diaphragm lies on the rigid shell, and how far it slides there."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Bools
from cloth.shell.shell import Shell

EXACT = 1e-12  # of the shell's size, within which a node is where it was


def slid(start: Array, end: Array, pressed: Bools, shell: Shell) -> Array:
    """Return how far each node has slid along the shell in a straight motion.

    That is the part of the motion across the shell's normal at its middle.

    Parameters
    ----------
    start, end
        Positions (n, 3) [m] at either end of the motion.
    pressed
        Nodes that press on the shell (n,); the others slide by 0.
    shell
        The shell.

    Returns
    -------
    Array
        Way of each node (n,) [m].
    """
    normal, move = shell.normal(0.5 * (start + end)), end - start
    along = move - np.sum(move * normal, axis=1)[:, None] * normal
    return np.where(pressed, np.linalg.norm(along, axis=1), 0.0)


def stuck(start: Array, place: Array, shell: Shell, rub: Array) -> Bools:
    """Return which nodes friction on the shell holds where they were.

    Parameters
    ----------
    start
        Positions (n, 3) [m] at the step's start.
    place
        Where the contact with the shell puts the nodes (n, 3) [m].
    shell
        The shell.
    rub
        Force of friction along the shell (n, 3) [N].

    Returns
    -------
    Bools
        Nodes (n,) with friction whose place is, to rounding, the shell's nearest point to their
        start.
    """
    there = np.abs(place - shell.project(start)).max(axis=1) <= EXACT * shell.size
    return np.asarray(there & rub.any(axis=1))
