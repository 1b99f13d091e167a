"""The energy of a mesh's corners, each a small neo-Hookean body (form: ``elastic_mesh``)."""

from __future__ import annotations

import math

import numpy as np

from cloth.compiled import compiled
from coupling.ports import Array, Ints

FLATTEST = 1e-9  # over s: least d of a valid corner


@compiled
def corner_energy(
    points: Array,
    corners: Ints,
    inverse: Array,
    size: float,
    weight: float,
    e: float,
    gradient: Array,
) -> float:
    """Return the energy [-] of all corners, and fill ``gradient`` with its gradient.

    Infinite where d of a corner is not above ``FLATTEST`` s and ``e`` is 0; the gradient is not
    complete then.

    Parameters
    ----------
    points
        Points of the mesh (P, 3) [m].
    corners
        A corner and its three neighbours, right-handed (k, 4).
    inverse
        Inverses of the reference's edge matrices (k, 3, 3) [1/m].
    size, weight, e
        Mean change of volume s, weight of the volume and the e of untangling [-].
    gradient
        Energy per displacement of every point (P, 3) [1/m], filled here.
    """
    gradient[:] = 0.0
    total = 0.0
    for k in range(corners.shape[0]):
        o, a, b, c = corners[k, 0], corners[k, 1], corners[k, 2], corners[k, 3]
        u0, u1, u2 = inverse[k, 0, 0], inverse[k, 0, 1], inverse[k, 0, 2]
        v0, v1, v2 = inverse[k, 1, 0], inverse[k, 1, 1], inverse[k, 1, 2]
        w0, w1, w2 = inverse[k, 2, 0], inverse[k, 2, 1], inverse[k, 2, 2]
        x, y, z = points[o, 0], points[o, 1], points[o, 2]
        ax, ay, az = points[a, 0] - x, points[a, 1] - y, points[a, 2] - z
        bx, by, bz = points[b, 0] - x, points[b, 1] - y, points[b, 2] - z
        cx, cy, cz = points[c, 0] - x, points[c, 1] - y, points[c, 2] - z
        # T, a row for each of x, y and z.
        x0, x1, x2 = (
            ax * u0 + bx * v0 + cx * w0,
            ax * u1 + bx * v1 + cx * w1,
            ax * u2 + bx * v2 + cx * w2,
        )
        y0, y1, y2 = (
            ay * u0 + by * v0 + cy * w0,
            ay * u1 + by * v1 + cy * w1,
            ay * u2 + by * v2 + cy * w2,
        )
        z0, z1, z2 = (
            az * u0 + bz * v0 + cz * w0,
            az * u1 + bz * v1 + cz * w1,
            az * u2 + bz * v2 + cz * w2,
        )
        f = x0 * x0 + x1 * x1 + x2 * x2 + y0 * y0 + y1 * y1 + y2 * y2
        f += z0 * z0 + z1 * z1 + z2 * z2
        # Cofactors, the gradient of d.
        p0, p1, p2 = y1 * z2 - y2 * z1, y2 * z0 - y0 * z2, y0 * z1 - y1 * z0
        q0, q1, q2 = z1 * x2 - z2 * x1, z2 * x0 - z0 * x2, z0 * x1 - z1 * x0
        r0, r1, r2 = x1 * y2 - x2 * y1, x2 * y0 - x0 * y2, x0 * y1 - x1 * y0
        d = x0 * p0 + x1 * p1 + x2 * p2
        if e == 0.0 and d <= FLATTEST * size:
            return np.inf
        far = math.sqrt(d * d + e * e)
        h = 0.5 * (d + far) if d > 0.0 else 0.5 * e * e / (far - d)  # in place of d, above 0
        root, square = h ** (-2.0 / 3.0), d * d + size * size
        total += f * root / 3.0 + 0.5 * weight * square / (size * h)
        t = 2.0 * root / 3.0
        s = -2.0 * f * root / (9.0 * far)
        s += 0.5 * weight * (2.0 * d / h - square / (h * far)) / size
        x0, x1, x2 = t * x0 + s * p0, t * x1 + s * p1, t * x2 + s * p2
        y0, y1, y2 = t * y0 + s * q0, t * y1 + s * q1, t * y2 + s * q2
        z0, z1, z2 = t * z0 + s * r0, t * z1 + s * r1, t * z2 + s * r2
        gx, gy, gz = (
            x0 * u0 + x1 * u1 + x2 * u2,
            y0 * u0 + y1 * u1 + y2 * u2,
            z0 * u0 + z1 * u1 + z2 * u2,
        )
        hx, hy, hz = (
            x0 * v0 + x1 * v1 + x2 * v2,
            y0 * v0 + y1 * v1 + y2 * v2,
            z0 * v0 + z1 * v1 + z2 * v2,
        )
        ix, iy, iz = (
            x0 * w0 + x1 * w1 + x2 * w2,
            y0 * w0 + y1 * w1 + y2 * w2,
            z0 * w0 + z1 * w1 + z2 * w2,
        )
        gradient[a, 0] += gx
        gradient[a, 1] += gy
        gradient[a, 2] += gz
        gradient[b, 0] += hx
        gradient[b, 1] += hy
        gradient[b, 2] += hz
        gradient[c, 0] += ix
        gradient[c, 1] += iy
        gradient[c, 2] += iz
        gradient[o, 0] -= gx + hx + ix
        gradient[o, 1] -= gy + hy + iy
        gradient[o, 2] -= gz + hz + iz
    return total
