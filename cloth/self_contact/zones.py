"""Zones of a sheet that move as rigid bodies where nothing else keeps them apart."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array, Ints


def merge_zones(zones: Ints, nodes: Ints) -> None:
    """Join, in place, the zones (n,) of each group of ``nodes`` (k, 4); their least label stays."""
    for group in nodes.tolist():
        labels = {int(zones[node]) for node in group}
        if len(labels) > 1:
            zones[np.isin(zones, list(labels))] = min(labels)


def _within(start: Array, shift: Array, limit: Array) -> float:
    """Largest share in [0, 1] of ``shift`` (3,) that keeps ``start`` (k, 3) inside ``limit``."""
    square = float(shift @ shift)
    if square <= 0.0:
        return 1.0
    half = start @ shift
    room = np.maximum(limit**2 - np.sum(start**2, axis=1), 0.0)
    with np.errstate(invalid="ignore"):
        share = (np.sqrt(half**2 + square * room) - half) / square
    return float(np.clip(np.where(np.isfinite(limit), share, 1.0), 0.0, 1.0).min())


def translated(
    start: Array, end: Array, nodes: Ints, zones: Ints, inverse_mass: Array, limit: Array
) -> Array:
    """``end`` (n, 3) [m] with every zone moved from ``start`` by its centre of mass's motion.

    The zones (n,) are first joined by the groups of ``nodes`` (k, 4), in place; a zone of one node
    stays as it is. A zone with a fixed node (``inverse_mass`` 0) does not move, and one that would
    leave ``limit`` (n,) [m] less: no zone's inside changes, so nothing in it can meet.
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
            shift *= _within(start[zone], shift, limit[zone])
        result[zone] = start[zone] + shift
    return result
