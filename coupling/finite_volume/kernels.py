"""Compiled loops over faces and cells; their results go into the arrays named last.

``tests/coupling/finite_volume/geometry_reference.py`` has the definitions in NumPy.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.compiled import compiled
from coupling.ports import Array, Ints

VSMALL = 1e-300


@compiled
def fans(corner: Array, centre: Array, area: Array) -> None:
    """Fill ``centre`` and ``area`` as ``finite_volume.geometry.face_centres_and_areas`` says.

    Parameters
    ----------
    corner
        Corners of the quadrilaterals (F, 4, 3) [m].
    centre
        Their centres (F, 3) [m], filled here.
    area
        Their area vectors (F, 3) [m^2], filled here.
    """
    for f in range(corner.shape[0]):
        c = corner[f]
        m0 = 0.25 * (c[0, 0] + c[1, 0] + c[2, 0] + c[3, 0])
        m1 = 0.25 * (c[0, 1] + c[1, 1] + c[2, 1] + c[3, 1])
        m2 = 0.25 * (c[0, 2] + c[1, 2] + c[2, 2] + c[3, 2])
        n0, n1, n2, s0, s1, s2, total = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(4):
            p, q = c[k], c[(k + 1) % 4]
            a0, a1, a2 = q[0] - p[0], q[1] - p[1], q[2] - p[2]
            b0, b1, b2 = m0 - p[0], m1 - p[1], m2 - p[2]
            x, y, z = a1 * b2 - a2 * b1, a2 * b0 - a0 * b2, a0 * b1 - a1 * b0
            weight = math.sqrt(x * x + y * y + z * z)
            n0, n1, n2, total = n0 + x, n1 + y, n2 + z, total + weight
            s0 += weight * (p[0] + q[0] + m0)
            s1 += weight * (p[1] + q[1] + m1)
            s2 += weight * (p[2] + q[2] + m2)
        scale = 1.0 / (3.0 * total + VSMALL)
        centre[f, 0], centre[f, 1], centre[f, 2] = scale * s0, scale * s1, scale * s2
        area[f, 0], area[f, 1], area[f, 2] = 0.5 * n0, 0.5 * n1, 0.5 * n2


@compiled
def triple(a: Array, b: Array, c: Array, o: Array, p: Array, q: Array) -> float:
    """Return the triple product (a - o) . ((b - p) x (c - q)).

    Parameters
    ----------
    a, b, c
        Points (3,) [m].
    o, p, q
        Points (3,) [m] that are subtracted from them.

    Returns
    -------
    float
        The product [m^3].
    """
    x0, x1, x2 = a[0] - o[0], a[1] - o[1], a[2] - o[2]
    y0, y1, y2 = b[0] - p[0], b[1] - p[1], b[2] - p[2]
    z0, z1, z2 = c[0] - q[0], c[1] - q[1], c[2] - q[2]
    volume = x0 * (y1 * z2 - y2 * z1) + x1 * (y2 * z0 - y0 * z2) + x2 * (y0 * z1 - y1 * z0)
    return float(volume)


@compiled
def sweeps(old: Array, new: Array, old_centre: Array, new_centre: Array, swept: Array) -> None:
    """Fill ``swept`` as ``coupling.finite_volume.geometry.swept_volumes`` says.

    Parameters
    ----------
    old, new
        Corners of the quadrilaterals before and after the motion (F, 4, 3) [m].
    old_centre, new_centre
        Their centres (F, 3) [m].
    swept
        The swept volumes (F,) [m^3], filled here.
    """
    for f in range(old.shape[0]):
        total = 0.0
        for k in range(4):
            # Triangles run (centre, this corner, next corner), as in face.C.
            p, q, r = old_centre[f], old[f, k], old[f, (k + 1) % 4]
            tp, tq, tr = new_centre[f], new[f, k], new[f, (k + 1) % 4]
            total += 2.0 * triple(tp, q, r, p, p, p) + triple(tq, r, tp, q, q, q)
            total += triple(r, tq, tp, tr, tr, tr) + triple(q, tp, tr, tq, tq, tq)
            total += triple(r, q, tp, tr, tr, tr)
        swept[f] = total / 12.0


@compiled
def cones(corner: Array, centre: Array, cone: Array) -> None:
    """Fill ``cone`` with the volumes from the origin to each quadrilateral's fan of triangles.

    Parameters
    ----------
    corner
        Corners of the quadrilaterals (F, 4, 3) [m].
    centre
        Apices of the fans (F, 3) [m].
    cone
        The volumes (F,) [m^3], filled here; negative for a fan that is seen clockwise from outside.
    """
    for f in range(corner.shape[0]):
        m, total = centre[f], 0.0
        for k in range(4):
            p, q = corner[f, k], corner[f, (k + 1) % 4]
            total += m[0] * (p[1] * q[2] - p[2] * q[1])
            total += m[1] * (p[2] * q[0] - p[0] * q[2])
            total += m[2] * (p[0] * q[1] - p[1] * q[0])
        cone[f] = total / 6.0


@compiled
def cells(
    owner: Ints, neighbour: Ints, face_centre: Array, area: Array, volume: Array, centre: Array
) -> None:
    """Fill ``volume`` and ``centre`` as ``coupling.finite_volume.geometry.cell_geometry`` says.

    Every cell has six faces, and a volume that is not 0: neither is checked.

    Parameters
    ----------
    owner, neighbour
        Cells on both sides of the faces, (F,) and those of the inner faces (inner,).
    face_centre, area
        Centres (F, 3) [m] and area vectors (F, 3) [m^2] of the faces.
    volume, centre
        Volumes (c,) [m^3] and centres (c, 3) [m] of the cells, filled here.
    """
    inner = len(neighbour)
    estimate, moment = np.zeros_like(centre), np.zeros_like(centre)
    volume[:] = 0.0
    for f in range(len(owner)):
        for d in range(3):
            estimate[owner[f], d] += face_centre[f, d] / 6.0
            if f < inner:
                estimate[neighbour[f], d] += face_centre[f, d] / 6.0
    for f in range(len(owner)):
        for side in range(2 if f < inner else 1):
            c, sign = (owner[f], 1.0) if side == 0 else (neighbour[f], -1.0)
            pyramid = 0.0
            for d in range(3):
                pyramid += sign * area[f, d] * (face_centre[f, d] - estimate[c, d]) / 3.0
            volume[c] += pyramid
            for d in range(3):
                moment[c, d] += pyramid * (0.75 * face_centre[f, d] + 0.25 * estimate[c, d])
    for c in range(len(volume)):
        for d in range(3):
            centre[c, d] = moment[c, d] / volume[c]
