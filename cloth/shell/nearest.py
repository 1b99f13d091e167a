"""The nearest point of a meridian, in compiled code.

A meridian's rows are those of ``cloth.shell.kernels``.
"""

from __future__ import annotations

import math

from cloth.arrays import Array
from cloth.compiled import compiled


@compiled
def nearest_on_piece(
    profile: Array, k: int, r: float, z: float
) -> tuple[float, float, float, float, float]:
    """Return what ``nearest_on`` does of piece ``k`` alone."""
    r0, z0, r1, z1 = profile[k, 0], profile[k, 1], profile[k, 2], profile[k, 3]
    a, b, radius = profile[k, 4], profile[k, 5], profile[k, 6]
    if radius == 0.0:
        tr, tz = r1 - r0, z1 - z0
        share = ((r - r0) * tr + (z - z0) * tz) / (tr * tr + tz * tz)
        share = min(1.0, max(0.0, share))
        length = math.sqrt(tr * tr + tz * tz)
        return r0 + share * tr, z0 + share * tz, tz / length, -tr / length, 0.0
    turn = 1.0 if radius > 0.0 else -1.0
    nr, nz = r - a, z - b
    after = turn * ((r0 - a) * nz - (z0 - b) * nr) >= 0.0
    before = turn * (nr * (z1 - b) - nz * (r1 - a)) >= 0.0
    if not (after and before):
        first = (r - r0) ** 2 + (z - z0) ** 2 <= (r - r1) ** 2 + (z - z1) ** 2
        nr, nz = (r0 - a, z0 - b) if first else (r1 - a, z1 - b)
    length = math.sqrt(nr * nr + nz * nz)
    if length == 0.0:  # at the centre, from which all of the arc is as near
        nr, nz, length = r0 - a, z0 - b, turn * radius
    nr, nz = turn * nr / length, turn * nz / length
    return a + radius * nr, b + radius * nz, nr, nz, 1.0 / radius


@compiled
def nearest_on(profile: Array, r: float, z: float) -> tuple[float, float, float, float, float]:
    """Return the nearest point of a meridian to (``r``, ``z``) [m], the normal and curvature there.

    As r and z [m], the outward normal's r and z, and the curvature [1/m]. From the piece at the
    height z upwards, then downwards, as far as heights leave a chance: they rise along a meridian.
    """
    low, high = 0, profile.shape[0] - 1
    while low < high:
        middle = (low + high) // 2
        if profile[middle, 3] < z:
            low = middle + 1
        else:
            high = middle
    best, found = math.inf, (0.0, 0.0, 0.0, 0.0, 0.0)
    for way in (1, -1):
        k = low if way > 0 else low - 1
        while 0 <= k < profile.shape[0]:
            away = profile[k, 1] - z if way > 0 else z - profile[k, 3]
            if away > 0.0 and away * away > best:
                break
            one = nearest_on_piece(profile, k, r, z)
            square = (r - one[0]) ** 2 + (z - one[1]) ** 2
            if square < best:
                best, found = square, one
            k += way
    return found
