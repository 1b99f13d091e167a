"""The shell in compiled code: where nodes that leave it belong.

A shell comes as its ``profile``, whose number of columns says what it is:

* (0, 1): there is no shell;
* (1, 1): a sphere about the origin, by its radius [m];
* (k, 7): a surface of revolution about z, by its meridian from the lower pole to the upper one,
  a line or an arc to a row: the start's r and z, the end's r and z, an arc's centre's r and z, and
  its radius [m]: above 0 where the shell is convex, below 0 where it is concave, 0 for a line.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.compiled import compiled
from cloth.shell.nearest import nearest_on

FLAT = 1e-9  # curvature times distance, below which a surface is taken for flat


@compiled
def nearest_point(profile: Array, y: Array, place: Array, normal: Array) -> tuple[float, float]:
    """Find the shell's nearest point to ``y``, and the normal there; the shell has a meridian.

    Returns how far ``y`` lies beyond it [m], below 0 inside, and the meridian's curvature there
    [1/m]. On the axis the half plane of positive x is taken.

    Parameters
    ----------
    profile
        The shell, as this module describes it.
    y
        The point asked for (3,) [m].
    place, normal
        Become the nearest point (3,) [m] and the outward unit normal there (3,).
    """
    r = math.sqrt(y[0] * y[0] + y[1] * y[1])
    c, s = (y[0] / r, y[1] / r) if r > 0.0 else (1.0, 0.0)
    pr, pz, nr, nz, bend = nearest_on(profile, r, y[2])
    place[0], place[1], place[2] = pr * c, pr * s, pz
    normal[0], normal[1], normal[2] = nr * c, nr * s, nz
    return (r - pr) * nr + (y[2] - pz) * nz, bend


@compiled
def nearest_points(profile: Array, x: Array, place: Array, normal: Array, beyond: Array) -> None:
    """Fill in ``nearest_point`` of all ``x`` (n, 3), its first result into ``beyond`` (n,)."""
    for i in range(len(x)):
        beyond[i], _ = nearest_point(profile, x[i], place[i], normal[i])


@compiled
def into_sphere(radius: float, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the nearest point to (x, y, z) [m] in the sphere of ``radius`` [m] about the origin.

    Small enough to be compiled into the loop that calls it.
    """
    scale = min(1.0, radius / max(math.sqrt(x * x + y * y + z * z), 1e-30))
    return scale * x, scale * y, scale * z


@compiled
def nearest_within(profile: Array, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return the nearest point to (x, y, z) [m] that is not beyond the shell of ``profile``.

    Coordinates in place of arrays: a call that passes these takes 60 ns, and this is one a node.
    """
    if profile.shape[0] == 0:
        return x, y, z
    if profile.shape[1] == 1:
        return into_sphere(profile[0, 0], x, y, z)
    r = math.sqrt(x * x + y * y)
    pr, pz, nr, nz, _ = nearest_on(profile, r, z)
    if (r - pr) * nr + (z - pz) * nz <= 0.0:
        return x, y, z
    c, s = (x / r, y / r) if r > 0.0 else (1.0, 0.0)
    return pr * c, pr * s, pz


@compiled
def keep_within(profile: Array, place: Array) -> None:
    """Move a point to the nearest point of the shell if it lies beyond it.

    Parameters
    ----------
    profile
        The shell, as this module describes it.
    place
        The point (3,) [m], which is moved.
    """
    place[0], place[1], place[2] = nearest_within(profile, place[0], place[1], place[2])


@compiled
def outward_part(profile: Array, place: Array, vector: Array, part: Array) -> None:
    """Put the part of ``vector`` (3,) along the shell's normal at ``place`` (3,) into ``part``.

    Where it points outward; elsewhere, and without a shell, ``part`` (3,) stays as it is.
    """
    if profile.shape[0] == 0:
        return
    along, square = 0.0, 1e-60
    if profile.shape[1] == 1:
        for d in range(3):
            along += vector[d] * place[d]
            square += place[d] * place[d]
        if along > 0.0:
            for d in range(3):
                part[d] = along / square * place[d]
        return
    near, normal = np.empty(3), np.empty(3)
    nearest_point(profile, place, near, normal)
    for d in range(3):
        along += vector[d] * normal[d]
    if along > 0.0:
        for d in range(3):
            part[d] = along * normal[d]


@compiled
def settle_on(
    profile: Array, y: Array, friction: float, start: Array, place: Array, normal: Array
) -> bool:
    """Put where a node that is asked for at ``y`` (3,) [m] belongs into ``place`` (3,) [m].

    Within the shell that is ``y``. Beyond it, where y - place is in the cone of ``friction`` about
    the ``normal`` (3,) there, as ``cloth.node_reference.contact_step`` says, for a node that was at
    ``start`` (3,) [m]. Returns whether it touches; the normal is given where it does.
    """
    if profile.shape[0] == 0:
        place[0], place[1], place[2] = y[0], y[1], y[2]
        return False
    if profile.shape[1] == 1:
        limit = profile[0, 0]
        radius = math.sqrt(y[0] * y[0] + y[1] * y[1] + y[2] * y[2])
        scale = min(1.0, limit / max(radius, 1e-30))
        if scale >= 1.0 or friction <= 0.0:
            place[0], place[1], place[2] = scale * y[0], scale * y[1], scale * y[2]
            if scale < 1.0:
                normal[0], normal[1], normal[2] = y[0] / radius, y[1] / radius, y[2] / radius
            return bool(scale < 1.0)
        slide_to(y[0] / radius, y[1] / radius, y[2] / radius, start, friction, scale, normal)
        place[0], place[1], place[2] = limit * normal[0], limit * normal[1], limit * normal[2]
        return True
    beyond, bend = nearest_point(profile, y, place, normal)
    if beyond <= 0.0:
        place[0], place[1], place[2] = y[0], y[1], y[2]
        return False
    if friction > 0.0:
        slide_along(profile, beyond, bend, friction, start, place, normal)
    return True


@compiled
def slide_to(
    e0: float, e1: float, e2: float, start: Array, friction: float, scale: float, place: Array
) -> None:
    """Put the direction where friction leaves a node asked for along e into ``place`` (3,).

    On the great circle from the unit vector e to that of ``start`` (3,), at most so far that it is
    there; ``scale``: the shell's radius over the distance asked for.
    """
    size = math.sqrt(start[0] ** 2 + start[1] ** 2 + start[2] ** 2)
    s0, s1, s2 = start[0] / size, start[1] / size, start[2] / size
    cosine = e0 * s0 + e1 * s1 + e2 * s2
    t0, t1, t2 = s0 - cosine * e0, s1 - cosine * e1, s2 - cosine * e2
    sine = math.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    cone = math.atan(friction)
    turn = cone - math.asin(math.sin(cone) * scale)
    if math.atan2(sine, cosine) <= turn:
        place[0], place[1], place[2] = s0, s1, s2
        return
    c, s = math.cos(turn), math.sin(turn) / max(sine, 1e-300)
    place[0], place[1], place[2] = c * e0 + s * t0, c * e1 + s * t1, c * e2 + s * t2


@compiled
def slide_along(
    profile: Array,
    beyond: float,
    bend: float,
    friction: float,
    start: Array,
    place: Array,
    normal: Array,
) -> None:
    """Move ``place`` (3,) [m] along a shell with a meridian to where friction leaves the node.

    ``place``, its ``normal`` (3,), ``beyond`` [m] and ``bend`` [1/m] are ``nearest_point``'s. As
    ``slide_to``, on the circle that has the surface's curvature in the direction of ``start``
    (Euler's formula, with the parallel circle's n_r/r for the other principal curvature), a
    straight line where that is 0 or concave; what leaves the surface by its change of curvature
    is projected back.
    """
    home, at_home = place.copy(), normal.copy()
    nearest_point(profile, start, home, at_home)
    t0, t1, t2 = home[0] - place[0], home[1] - place[1], home[2] - place[2]
    along = t0 * normal[0] + t1 * normal[1] + t2 * normal[2]
    t0, t1, t2 = t0 - along * normal[0], t1 - along * normal[1], t2 - along * normal[2]
    way = math.sqrt(t0 * t0 + t1 * t1 + t2 * t2)
    r = math.sqrt(place[0] ** 2 + place[1] ** 2)
    across = 0.0 if r <= 0.0 else (t1 * place[0] - t0 * place[1]) / (r * max(way, 1e-300))
    nr = math.sqrt(normal[0] ** 2 + normal[1] ** 2)
    hoop = bend if r <= 0.0 else nr / r
    curvature = (1.0 - across * across) * bend + across * across * hoop
    cone = math.atan(friction)
    if curvature * (beyond + way) <= FLAT:
        stays, forth, up = way <= friction * beyond, friction * beyond, 0.0
    else:
        radius = 1.0 / curvature
        turn = cone - math.asin(math.sin(cone) * radius / (radius + beyond))
        stays = math.atan2(way, radius + along) <= turn
        forth, up = radius * math.sin(turn), radius * (math.cos(turn) - 1.0)
    if stays:
        for d in range(3):
            place[d], normal[d] = home[d], at_home[d]
        return
    share = forth / max(way, 1e-300)
    home[0] = place[0] + up * normal[0] + share * t0
    home[1] = place[1] + up * normal[1] + share * t1
    home[2] = place[2] + up * normal[2] + share * t2
    nearest_point(profile, home, place, normal)
