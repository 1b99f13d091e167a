"""A run's diaphragm at an instant as a surface that points are held against."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from cloth.compiled import compiled
from coupling.interface.sheet_distance import nearest_on_sheet
from coupling.ports import AnyArray, Array, Ints

# Degrees off the horizontal beyond which a face has no vertical difference: there an error of the
# place comes out 3.9 times as large, and towards a wall without limit.
STEEPEST = 75.0
_ON_EDGE = 1e-9  # share of a triangle's third corner, below which a point is on the other's edge
ROUNDING = 1e-9  # of the sheet's size: distances below are none
_SAME_LAYER = 1e-6  # of the sheet's size: heights of one place, on a side that triangles share
_BLOCK = 100_000  # points at once


@dataclass(frozen=True, kw_only=True)
class Matches:
    """What points have on the sheet that is nearest to them.

    Attributes
    ----------
    distance
        Signed distances (p,) [m], positive on the side that the triangles face, the gas.
    way
        Unit vectors (p, 3) along which each of them grows.
    triangle
        Triangles (p,) of the nearest points.
    shares
        Their barycentric coordinates (p, 3).
    beyond
        Whether (p,) the nearest point is on the sheet's border: beyond that it has no counterpart.
    """

    distance: Array
    way: Array
    triangle: Ints
    shares: Array
    beyond: AnyArray


@dataclass(frozen=True, kw_only=True)
class Heights:
    """How far points lie above the sheet, along the tank's axis.

    Attributes
    ----------
    difference
        Height (p,) [m] above the layer that is nearest in height; NaN where no layer is above or
        below, or that one is steeper than ``STEEPEST``.
    slope
        How it grows with the point's place (p, 3).
    none, steep, several
        Whether (p,) there is no layer, it is too steep, there is more than one.
    """

    difference: Array
    slope: Array
    none: AnyArray
    steep: AnyArray
    several: AnyArray


class Sheet:
    """A diaphragm: ``nodes`` (n, 3) [m] and ``triangles`` (m, 3) in the tank's frame."""

    def __init__(self, nodes: Array, triangles: Ints) -> None:
        self.nodes, self.triangles = nodes, triangles.astype(np.int64)
        self.size = float(np.linalg.norm(np.ptp(nodes, axis=0)))
        corner = nodes[self.triangles]
        self._area_normal = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        self.normal = _unit(self._area_normal)

    @cached_property
    def _node_normal(self) -> Array:
        """Normals (n, 3) of the nodes: those of their triangles, weighted by area."""
        found = np.zeros_like(self.nodes)
        for k in range(3):
            np.add.at(found, self.triangles[:, k], self._area_normal)
        return _unit(found)

    @cached_property
    def _border(self) -> AnyArray:
        """Whether (m, 3) the side that faces each corner of a triangle bounds the sheet."""
        sides = np.sort(self.triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
        _, place, number = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
        found: AnyArray = (number[place.ravel()] == 1).reshape(-1, 3)
        return found

    def smooth_normal(self, matches: Matches) -> Array:
        """Normals (p, 3) at matched points of the smooth surface that the triangles stand for."""
        corners = self._node_normal[self.triangles[matches.triangle]]
        return _unit(np.einsum("pk,pkd->pd", matches.shares, corners))

    def facet_error(self, matches: Matches) -> float:
        """How far the triangles lie off the smooth surface through their nodes, rms [m].

        Over the matched points. Half the offset of Phong tessellation (Boubekeur and Alexa, ACM
        Trans. Graphics 27, 2008), which is the sagitta of a sphere to leading order.
        """
        nodes = self.triangles[matches.triangle]
        corner = self.nodes[nodes]
        foot = np.einsum("pk,pkd->pd", matches.shares, corner)
        above = np.einsum("pkd,pkd->pk", corner - foot[:, None], self._node_normal[nodes])
        offset = 0.5 * np.einsum("pk,pk->p", matches.shares, above)
        return float(np.sqrt(np.mean(offset**2)))

    def match(self, points: Array) -> Matches:
        """Return what ``points`` (p, 3) [m] have on the sheet nearest to them."""
        parts = [
            nearest_on_sheet(points[i : i + _BLOCK], self.nodes, self.triangles)
            for i in range(0, len(points), _BLOCK)
        ]
        distance, triangle, shares = (np.concatenate(part) for part in zip(*parts, strict=True))
        foot = np.einsum("pk,pkd->pd", shares, self.nodes[self.triangles[triangle]])
        facing = self.normal[triangle]
        corners = self._node_normal[self.triangles[triangle]]
        outward = np.einsum("pk,pkd->pd", shares, corners)
        offset = points - foot
        sign = np.where(np.einsum("pd,pd->p", offset, outward) < 0.0, -1.0, 1.0)
        near = distance <= ROUNDING * self.size
        way = offset * (sign / np.where(near, 1.0, distance))[:, None]
        return Matches(
            distance=sign * distance,
            way=np.where(near[:, None], facing, way),
            triangle=triangle,
            shares=shares,
            beyond=(self._border[triangle] & (shares < _ON_EDGE)).any(axis=1),
        )

    def is_steep(self, triangle: Ints) -> AnyArray:
        """Whether triangles (p,) are too steep for a vertical difference."""
        found: AnyArray = np.abs(self.normal[triangle, 2]) < np.cos(np.radians(STEEPEST))
        return found

    def heights(self, points: Array) -> Heights:
        """Return how far ``points`` (p, 3) [m] lie above the sheet, along the tank's axis."""
        box = self.nodes[self.triangles][:, :, :2]
        difference, triangle, apart = _heights(
            points, self.nodes, self.triangles, box.min(axis=1), box.max(axis=1)
        )
        none = ~np.isfinite(difference)
        normal = self.normal[triangle]
        steep = self.is_steep(triangle) & ~none
        left_out = steep | none
        upright = np.where(left_out, 1.0, normal[:, 2])
        return Heights(
            difference=np.where(left_out, np.nan, difference),
            slope=np.where(left_out[:, None], 0.0, normal / upright[:, None]),
            none=none,
            steep=steep,
            several=apart > _SAME_LAYER * self.size,
        )


def _unit(vectors: Array) -> Array:
    found: Array = vectors / np.maximum(np.linalg.norm(vectors, axis=1), 1e-300)[:, None]
    return found


@compiled
def _heights(
    points: Array, nodes: Array, triangles: Ints, low: Array, high: Array
) -> tuple[Array, Ints, Array]:
    """Height (p,) of points above the layer nearest in height, its triangle, range of all heights.

    ``low``, ``high`` (m, 2): least and largest x and y of the triangles. Without a layer the height
    is infinite.
    """
    number = len(points)
    nearest, chosen = np.full(number, np.inf), np.zeros(number, dtype=np.int64)
    apart = np.zeros(number)
    for i in range(number):
        x, y, z = points[i]
        least, most = np.inf, -np.inf
        for t in range(len(triangles)):
            if x < low[t, 0] or x > high[t, 0] or y < low[t, 1] or y > high[t, 1]:
                continue
            a, b, c = nodes[triangles[t, 0]], nodes[triangles[t, 1]], nodes[triangles[t, 2]]
            whole = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
            if whole == 0.0:
                continue
            u = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / whole
            v = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / whole
            if u < 0.0 or v < 0.0 or u + v > 1.0:
                continue
            height = z - a[2] - u * (b[2] - a[2]) - v * (c[2] - a[2])
            least, most = min(least, height), max(most, height)
            if abs(height) < abs(nearest[i]):
                nearest[i], chosen[i] = height, t
        if most > least:
            apart[i] = most - least
    return nearest, chosen, apart
