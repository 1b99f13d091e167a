"""Lines and arcs in the half plane of r and z, of which a meridian consists.

A piece is a row (7,) as compiled code has it (``cloth.shell.kernels``).
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Array

JOINT = 1e-12  # over the size, by which what should be the same may differ
SAMPLES = 33  # places of a piece where it is checked
KINK = 1e-6  # angle between two pieces' normals, above which they join in an edge
LOOKS = 65  # points of a piece between which it crosses a plane once at most


def line(start: tuple[float, float], end: tuple[float, float]) -> Array:
    """Return a straight piece (7,) from ``start`` to ``end``, each r and z [m]."""
    return np.array([*start, *end, 0.0, 0.0, 0.0])


def arc(centre: tuple[float, float], radius: float, start: float, end: float) -> Array:
    """Return a piece (7,) of the circle of ``radius`` [m] about ``centre`` (r and z [m]).

    From the angle ``start`` to ``end`` [rad], 0 at the largest r: rising where the shell is convex.
    Raises ValueError for more than half a circle, which compiled code cannot tell from the rest of
    it.
    """
    if abs(end - start) > math.pi * (1.0 + JOINT):
        raise ValueError(f"meridian: an arc may be half a circle, got {abs(end - start):g} rad.")
    a, b = centre
    ends = [(a + radius * math.cos(angle), b + radius * math.sin(angle)) for angle in (start, end)]
    return np.array([*ends[0], *ends[1], a, b, math.copysign(radius, end - start)])


def raised(piece: Array, height: float) -> Array:
    """Return a ``piece`` (7,) moved up by a ``height`` [m]."""
    return np.asarray(piece + height * np.array([0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0]))


def share_below(piece: Array, height: float) -> float:
    """Return the share of a ``piece`` (7,) that lies below the ``height`` [m] it rises through."""

    def above(share: float) -> float:
        return float(piece_points(piece[None], np.array([share]))[1][0]) - height

    return float(brentq(above, 0.0, 1.0, xtol=1e-16))


def crossings(piece: Array, level: float, lean: float, rise: float) -> list[float]:
    """Return the shares of a ``piece`` (7,) at which it or its mirror image meets a plane.

    Sorted, with 0 and 1 for its ends. The plane is ``lean`` r + ``rise`` z = ``level`` [m].
    """
    share, found = np.linspace(0.0, 1.0, LOOKS), [0.0, 1.0]
    for side in (lean, -lean):

        def beyond(at: Array | float, side: float = side) -> Array:
            at = np.atleast_1d(at)
            r, z, _, _ = piece_points(np.tile(piece, (len(at), 1)), at)
            return np.asarray(side * r + rise * z - level)

        value = beyond(share)
        for k in np.flatnonzero((value[:-1] < 0.0) != (value[1:] < 0.0)):
            found.append(float(brentq(lambda at: beyond(at)[0], share[k], share[k + 1])))
    return sorted(found)


def _angles(pieces: Array) -> tuple[Array, Array]:
    """Angles (n,) [rad] at which arcs among ``pieces`` (n, 7) start, and by which they turn."""
    r0, z0, r1, z1, a, b, radius = pieces.T
    sign = np.sign(radius)
    start = np.arctan2(z0 - b, r0 - a)
    turn = sign * ((sign * (np.arctan2(z1 - b, r1 - a) - start)) % (2.0 * np.pi))
    return start, turn


def piece_length(piece: Array) -> float:
    """Return the length [m] of a ``piece`` (7,)."""
    if piece[6] == 0.0:
        return math.hypot(piece[2] - piece[0], piece[3] - piece[1])
    return abs(float(piece[6] * _angles(piece[None])[1][0]))


def piece_points(pieces: Array, share: Array) -> tuple[Array, Array, Array, Array]:
    """Return points of a meridian's pieces, and the shell's normals there.

    Parameters
    ----------
    pieces
        The piece of each point (n, 7).
    share
        Place of each point as a share of its piece's length, from its start (n,) [-].

    Returns
    -------
    r, z : Array
        The points (n,) [m].
    nr, nz : Array
        The outward unit normals' components (n,).
    """
    r0, z0, r1, z1, a, b, radius = pieces.T
    straight = radius == 0.0
    start, turn = _angles(pieces)
    angle = start + share * turn
    sign, size = np.sign(radius), np.abs(radius)
    length = np.where(straight, np.hypot(r1 - r0, z1 - z0), 1.0)
    r = np.where(straight, r0 + share * (r1 - r0), a + size * np.cos(angle))
    z = np.where(straight, z0 + share * (z1 - z0), b + size * np.sin(angle))
    nr = np.where(straight, (z1 - z0) / length, sign * np.cos(angle))
    nz = np.where(straight, (r0 - r1) / length, sign * np.sin(angle))
    return r, z, nr, nz


def check_smooth(pieces: Array) -> None:
    """See that the distance from a meridian of ``pieces`` (k, 7) has one meaning near it.

    Raises ValueError where two pieces join in an edge, a ray from the origin meets it more than
    once, or its height does not rise; the latter two by ``SAMPLES`` places of each piece.
    """
    share = np.tile(np.linspace(0.0, 1.0, SAMPLES), len(pieces))
    r, z, nr, nz = piece_points(np.repeat(pieces, SAMPLES, axis=0), share)
    place, normal = np.stack([r, z], axis=1), np.stack([nr, nz], axis=1)
    before, after = normal[SAMPLES - 1 : -1 : SAMPLES], normal[SAMPLES::SAMPLES]
    if np.abs(before - after).max(initial=0.0) > KINK:
        raise ValueError("meridian: pieces must join without a kink: round the edge by an arc.")
    if np.einsum("nx,nx->n", place, normal).min() <= 0.0:
        raise ValueError("meridian: a ray from the origin must meet it once.")
    if np.diff(z.reshape(-1, SAMPLES), axis=1).min() <= 0.0:
        raise ValueError("meridian: its height must rise from the lower pole to the upper one.")
