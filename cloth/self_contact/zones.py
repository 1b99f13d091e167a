"""Zones of a sheet that move as rigid bodies where nothing else keeps them apart."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints
from cloth.shell.shell import Shell


def merge_zones(zones: Ints, nodes: Ints) -> None:
    """Join, in place, the zones (n,) of each group of ``nodes`` (k, 4); their least label stays."""
    for group in nodes.tolist():
        labels = {int(zones[node]) for node in group}
        if len(labels) > 1:
            zones[np.isin(zones, list(labels))] = min(labels)


def translated(
    start: Array, end: Array, nodes: Ints, zones: Ints, inverse_mass: Array, shell: Shell
) -> Array:
    """``end`` (n, 3) [m] with every zone moved from ``start`` by its centre of mass's motion.

    The zones (n,) are first joined by the groups of ``nodes`` (k, 4), in place; a zone of one node
    stays as it is. A zone with a fixed node (``inverse_mass`` 0) does not move, and one that would
    leave the ``shell`` less: no zone's inside changes, so nothing in it can meet.
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
