"""Folds of the diaphragm: how many, where, how sharp, and what is folded over.

A fold is a ridge: a maximum of the larger principal curvature along a closed material curve, on
either side of the sheet. The curves are the rings of the diaphragm's grid, circles as moulded.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.signal import find_peaks

from cloth.principal_curvature import PrincipalCurvature
from coupling.metrics.bernoulli import node_areas
from coupling.metrics.places import degrees_of, mould_angles
from coupling.ports import Array, Ints

# Over the curvature of a sphere of the rim's radius: by as much more a ridge is bent than the sheet
# on either side of it, which separates folds from the moulded curvature and from what a round level
# sheet has. Scale-free, and no property of the rubber.
PROMINENCE = 1.0
LEAST = 8  # nodes of a ring on which two folds could be distinguished
TENTH = 0.1  # of the area: its radius converges with the grid, the sharpest of all does not
SAME = 1e-9  # of the rim's radius, within which nodes lie on one ring


@dataclass(frozen=True, kw_only=True)
class Folds:
    """Folds at an instant.

    ``ridges`` (k,): the nodes that are ridges on the ring with most of them; ``radius`` [m]: the
    sharpest radius of curvature, and the ``node`` where that is; ``tenth_radius`` [m]: the radius
    that the sharpest tenth of the moulded area is bent to or below.
    """

    ridges: Ints
    radius: float
    node: int
    tenth_radius: float


class FoldFinder:
    """Finds folds of a sheet moulded at ``reference`` (n, 3) [m] with ``triangles`` (m, 3)."""

    def __init__(self, reference: Array, triangles: Ints) -> None:
        self.reference, self.triangles = reference, triangles
        self._distance = np.hypot(reference[:, 0], reference[:, 1])
        self.size = float(self._distance.max())
        self._normal = _normals(reference, triangles)
        self._area = np.linalg.norm(self._normal, axis=1) / 2.0
        self._node_area = node_areas(reference[None], triangles)[0]

    @cached_property
    def _curvature(self) -> PrincipalCurvature:
        return PrincipalCurvature(self.reference, self.triangles)

    @cached_property
    def _rings(self) -> list[Ints]:
        """Nodes at one height and distance from the axis, in the order of azimuth."""
        azimuth = np.arctan2(self.reference[:, 1], self.reference[:, 0])
        levels = np.round(np.stack([self._distance, self.reference[:, 2]]) / (SAME * self.size))
        groups: defaultdict[tuple[float, float], list[int]] = defaultdict(list)
        for node, level in enumerate(levels.T.tolist()):
            if self._curvature.known[node]:
                groups[level[0], level[1]].append(node)
        return [
            np.array(sorted(nodes, key=lambda node: float(azimuth[node])))
            for nodes in groups.values()
            if len(nodes) >= LEAST
        ]

    def sharpness(self, position: Array) -> Array:
        """Return the size of the sharper curvature (n,) [1/m] at ``position`` (n, 3) [m]."""
        larger, smaller = self._curvature(position)
        return np.maximum(np.abs(larger), np.abs(smaller))

    def folds(self, position: Array) -> Folds:
        """Return the folds at ``position`` (n, 3) [m].

        Ridges are counted on both sides of the sheet, the larger number being taken: a wave has
        one on each. The sharpest radius is that of all nodes off the border, ridges or not.
        """
        larger, smaller = self._curvature(position)
        found = [np.zeros(0, dtype=np.int64)]
        for ring in self._rings:
            found += [
                ring[_peaks(side[ring], PROMINENCE / self.size)] for side in (larger, -smaller)
            ]
        most = np.maximum(np.abs(larger), np.abs(smaller))
        node = int(np.argmax(most))
        order = np.argsort(-most)
        area = np.cumsum(self._node_area[order])
        tenth = order[int(np.searchsorted(area, TENTH * area[-1]))]
        radius, tenth_radius = (1.0 / max(float(most[one]), 1e-300) for one in (node, tenth))
        return Folds(
            ridges=max(found, key=len), radius=radius, node=node, tenth_radius=tenth_radius
        )

    def folded_area(self, position: Array) -> float:
        """Return the moulded area [m^2] of faces whose normal has turned by more than 90 degrees.

        ``position`` (n, 3) [m]. A sheet that is everted as a whole has turned so where it was
        moulded steeper than 45 degrees.
        """
        turned = np.einsum("td,td->t", _normals(position, self.triangles), self._normal) < 0.0
        return float(self._area @ turned)

    @property
    def area(self) -> float:
        """Moulded area [m^2] of the sheet."""
        return float(self._area.sum())

    def place(self, node: int) -> tuple[float, float]:
        """Return where a ``node`` was moulded [degrees]: angle from the pole, azimuth from x."""
        return degrees_of(*mould_angles(self.reference[node]))


def _normals(position: Array, triangles: Ints) -> Array:
    """Normals (m, 3) [m^2] of twice each triangle's area; ``position`` (n, 3) [m]."""
    a, b, c = (position[triangles[:, corner]] for corner in range(3))
    return np.asarray(np.cross(b - a, c - a))


def _peaks(values: Array, prominence: float) -> Ints:
    """Maxima of a closed curve's ``values`` (k,) that rise by ``prominence`` above their sides."""
    least = int(np.argmin(values))
    opened = np.roll(values, -least)  # both ends at the least value: no maximum is cut
    peaks, _ = find_peaks(np.append(opened, opened[0]), prominence=prominence)
    return np.asarray((peaks + least) % len(values))
