"""Zones of a sheet that move as rigid bodies where nothing else keeps them apart."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.shell.shell import Shell


def merge_zones(zones: Ints, nodes: Ints) -> None:
    """Join, in place, the zones that groups of nodes connect; the least label of each stays.

    Parameters
    ----------
    zones
        Label of every node's zone (n,), which is changed.
    nodes
        Groups of four nodes (k, 4).
    """
    for group in nodes.tolist():
        labels = {int(zones[node]) for node in group}
        if len(labels) > 1:
            zones[np.isin(zones, list(labels))] = min(labels)


def translated(
    start: Array, end: Array, nodes: Ints, zones: Ints, inverse_mass: Array, shell: Shell
) -> Array:
    """Return the end of a motion in which every zone moves as its centre of mass does.

    A zone with a fixed node does not move, and one that would leave the shell moves less: no
    zone's inside changes, so nothing in it can meet. A zone of one node keeps its own end.

    Parameters
    ----------
    start, end
        Positions (n, 3) [m] at either end of the motion.
    nodes
        Groups of four nodes (k, 4), by which zones are joined first.
    zones
        Label of every node's zone (n,), which is changed.
    inverse_mass
        Inverse mass of the nodes (n,) [1/kg]; 0 where one is fixed.
    shell
        The shell that zones are kept in.

    Returns
    -------
    Array
        The end (n, 3) [m].
    """
    merge_zones(zones, nodes)
    result = end.copy()
    labels, counts = np.unique(zones, return_counts=True)
    for label in labels[counts > 1]:
        zone = np.flatnonzero(zones == label)
        shift = np.zeros(3)
        if np.all(inverse_mass[zone] > 0.0):
            mass = 1.0 / inverse_mass[zone]
            shift = mass @ (end[zone] - start[zone]) / mass.sum()
            shift *= shell.share_within(start[zone], shift)
        result[zone] = start[zone] + shift
    return result
