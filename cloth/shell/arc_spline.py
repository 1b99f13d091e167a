"""Smooth meridians of arcs: through points, and for an ellipse."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.shell.kernels import nearest_points
from cloth.shell.pieces import line, piece_points

EXACT = 1e-12  # over the size, within which points lie on an arc or line that is theirs
CLOSE = 1e-6  # over the size, by which others may lie off their arcs
STRAIGHT = 2e-8  # sine at which a line errs by as much as rounding errs in an arc, 1e-9 of a chord
WIDEST = 0.5 * math.pi * (1.0 + 1e-9)  # angle through which two arcs between two points turn
GHOSTS = 3  # points mirrored beyond each pole, so that tangents there are level
SMOOTHER = 0.1  # of the centred defect, below which the points of one side give the tangent
DENSE = 1000  # points of an ellipse's quarter


def through(points: Array) -> list[Array]:
    """Return the pieces (7,) of a smooth meridian through points from the lower to the upper pole.

    Between chosen points two arcs with a common tangent (a biarc), as far apart as leaves all
    points between within ``CLOSE`` of the size. Points of a circle or a line give it, to rounding.
    Elsewhere the pieces err between points by ``CLOSE`` and a term of the distance's third power.

    Parameters
    ----------
    points
        Points (n, 2), r and z [m], the first and the last with r = 0.
    """
    return spline(points, _tangents(points), CLOSE)


def ellipse(radius: float, semi_axis: float) -> list[Array]:
    """Return the pieces (7,) of half an ellipse, within ``CLOSE`` of its larger semi-axis.

    Parameters
    ----------
    radius, semi_axis
        Semi-axes [m] along r and z.
    """
    angle = np.linspace(-0.5 * np.pi, 0.0, DENSE)
    points = np.stack([radius * np.cos(angle), semi_axis * np.sin(angle)], axis=1)
    points[0, 0], points[-1, 1] = 0.0, 0.0
    tangents = np.stack([-radius * np.sin(angle), semi_axis * np.cos(angle)], axis=1)
    tangents[0], tangents[-1] = (1.0, 0.0), (0.0, 1.0)
    lower = spline(points, tangents / np.linalg.norm(tangents, axis=1)[:, None], CLOSE)
    return lower + [_mirrored(piece) for piece in lower[::-1]]


def _mirrored(piece: Array) -> Array:
    """A piece (7,) mirrored at z = 0, from its end to its start."""
    r0, z0, r1, z1, a, b, radius = piece
    return np.array([r1, -z1, r0, -z0, a, -b, radius])


def spline(points: Array, tangents: Array, tolerance: float) -> list[Array]:
    """Return pieces (7,) through the first and the last of ``points`` (n, 2) [m], close to all.

    A single arc or line reaches as far as all points between lie on it to rounding; elsewhere a
    pair of arcs as far as they are within the tolerance of the points, and of the middles of those
    pairs that join neighbours.

    Parameters
    ----------
    points, tangents
        Points (n, 2) [m] and unit tangents there (n, 2), in the direction of the points.
    tolerance
        Largest distance of a point from the pieces, over the largest coordinate [-].

    Returns
    -------
    list of Array
        The pieces. Raises ValueError where the tangents of two neighbours lie too far apart.
    """
    size, start, pieces = float(np.abs(points).max()), 0, []
    nodes = _Nodes(points, tangents)
    while start < len(points) - 1:
        end = nodes.reach(start, EXACT * size, most=1)
        if end == start + 1:
            end = nodes.reach(start, tolerance * size, most=2)
        pieces += nodes.biarc(start, end) or []
        start = end
    return pieces


class _Nodes:
    """``points`` (n, 2) [m] with ``tangents`` (n, 2), and how far a biarc reaches from one."""

    def __init__(self, points: Array, tangents: Array) -> None:
        self.points, self.tangents = points, tangents
        middles = []
        for start, (r, z) in enumerate(points[:-1]):
            found = self.biarc(start, start + 1)
            if found is None:
                raise ValueError(
                    f"meridian: it turns by 90 degrees or more at r = {r:g}, z = {z:g}."
                )
            middles.append(_middle(found))
        self.middles = np.array(middles)

    def biarc(self, start: int, end: int) -> list[Array] | None:
        """The pieces between two of the points."""
        return biarc(self.points[start], self.tangents[start], self.points[end], self.tangents[end])

    def reach(self, start: int, allowed: float, *, most: int) -> int:
        """The last point to which a biarc from ``start`` passes all between within ``allowed`` [m].

        Of at ``most`` so many pieces. At least the next point. By doubled steps, then halved ones.
        """

        def fits(end: int) -> bool:
            found = self.biarc(start, end)
            if found is None or len(found) > most:
                return False
            between = np.vstack([self.points[start + 1 : end], self.middles[start:end]])
            return bool(_distances(np.array(found), between).max() <= allowed)

        good, step, last = start + 1, 1, len(self.points) - 1
        while good + step <= last and fits(good + step):
            good += step
            step *= 2
        while step > 0:
            if good + step <= last and fits(good + step):
                good += step
            step //= 2
        return good


def _middle(pieces: list[Array]) -> Array:
    """A point (2,) of one or two pieces (7,) between their ends."""
    if len(pieces) == 2:
        return np.asarray(pieces[1][:2])
    r, z, _, _ = piece_points(pieces[0][None], np.array([0.5]))
    return np.array([r[0], z[0]])


def _distances(pieces: Array, points: Array) -> Array:
    """Distances (n,) [m] of ``points`` (n, 2) from ``pieces`` (k, 7)."""
    x = np.column_stack([points[:, 0], np.zeros(len(points)), points[:, 1]])
    place, normal, beyond = np.empty_like(x), np.empty_like(x), np.empty(len(x))
    nearest_points(pieces, x, place, normal, beyond)
    return np.asarray(np.linalg.norm(x - place, axis=1))


def biarc(start: Array, along: Array, end: Array, onward: Array) -> list[Array] | None:
    """Return the one or two pieces (7,) between two points with their tangents.

    Two arcs that meet with a common tangent, as long as each other at their ends' tangents (Bolton
    1975, Computer-Aided Design 7, 29). None where they turn by more than a right angle.

    Parameters
    ----------
    start, end
        Points (2,), r and z [m].
    along, onward
        Unit tangents there (2,).
    """
    way = end - start
    both, apart = along + onward, float((along - onward) @ (along - onward))
    ahead, square = float(way @ both), float(way @ way)
    chord = way / math.sqrt(square)
    if along @ onward < math.cos(WIDEST) or min(along @ chord, onward @ chord) <= 0.0:
        return None
    reflected = 2.0 * (along @ chord) * chord - along
    if np.abs(reflected - onward).max() <= EXACT:
        return [_arc(start, end, at=start, tangent=along)]
    # the root of square - 2 d ahead - d^2 apart = 0 of whole arcs, free of cancellation
    length = square / (ahead + math.sqrt(ahead**2 + apart * square))
    middle = 0.5 * (start + end + length * (along - onward))
    return [
        _arc(start, middle, at=start, tangent=along),
        _arc(middle, end, at=end, tangent=onward),
    ]


def _arc(start: Array, end: Array, *, at: Array, tangent: Array) -> Array:
    """The piece (7,) from ``start`` to ``end`` with a ``tangent`` ``at`` one of them, each (2,)."""
    way = (end if at is start else start) - at
    inward = np.array([-tangent[1], tangent[0]])
    square, rise = float(way @ way), float(way @ inward)
    if abs(rise) <= STRAIGHT * math.sqrt(square):
        return line((start[0], start[1]), (end[0], end[1]))
    radius = 0.5 * square / rise
    return np.array([*start, *end, *(at + radius * inward), radius])


def _tangents(points: Array) -> Array:
    """Unit tangents (n, 2) of a meridian at its points (n, 2), of circles through three of them.

    Of the circle about the point itself, whose tangent errs by k' a b/6 for a curvature's slope k'
    and neighbours at a and b, corrected by those of the two points beside it, which differ from it
    by k' (b + c) (a + b + c)/6 and so give k'. Where the curvature changes less by far on one side,
    of the three points there (as essentially non-oscillatory schemes choose theirs): at the joint
    of an arc and a line both have theirs.
    """
    mirror = np.array([-1.0, 1.0])
    x = np.vstack([mirror * points[GHOSTS:0:-1], points, mirror * points[-2 : -2 - GHOSTS : -1]])
    way = np.diff(x, axis=0)
    size = np.linalg.norm(way, axis=1)
    chord, before, after = way / size[:, None], way[:-1], way[1:]
    here = before / size[:-1, None] ** 2 + after / size[1:, None] ** 2
    here /= np.linalg.norm(here, axis=1)[:, None]
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    curvature = 2.0 * cross / (size[:-1] * size[1:] * np.linalg.norm(before + after, axis=1))
    change = np.abs(np.diff(curvature))

    def at(values: Array, shift: int) -> Array:
        """Of the circle about the point ``shift`` after each; ``here`` begins with x[1]."""
        return values[GHOSTS - 1 + shift : GHOSTS - 1 + shift + len(points)]

    left = _reflected(at(here, -1), at(chord, 0))
    right = _reflected(at(here, 1), at(chord, 1))
    centred = np.maximum(at(change, -1), at(change, 0))
    of_left, of_right = at(change, -2), at(change, 1)
    sided = np.where((of_left <= of_right)[:, None], left, right)
    better = np.minimum(of_left, of_right) < SMOOTHER * centred
    before_it, after_it = at(size, 0), at(size, 1)
    from_left = _angle(at(here, 0), left) * after_it / (at(size, -1) + before_it + after_it)
    from_right = _angle(at(here, 0), right) * before_it / (before_it + after_it + at(size, 2))
    turn = 0.5 * (from_left + from_right)
    across = at(here, 0)[:, ::-1] * [-1.0, 1.0]
    turned = np.cos(turn)[:, None] * at(here, 0) + np.sin(turn)[:, None] * across
    tangents = np.where(better[:, None], sided, turned)
    tangents[0], tangents[-1] = (1.0, 0.0), (-1.0, 0.0)
    return np.asarray(tangents)


def _angle(one: Array, other: Array) -> Array:
    """Angles (n,) [rad] from unit vectors (n, 2) to others near them."""
    return np.asarray(np.arcsin(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]))


def _reflected(tangent: Array, chord: Array) -> Array:
    """Tangents (n, 2) of circles at a chord's other end, from those at one; ``chord`` (n, 2)."""
    return np.asarray(2.0 * np.sum(tangent * chord, axis=1)[:, None] * chord - tangent)
