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
    edge, t, cof, p = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    for k in range(corners.shape[0]):
        for a in range(3):
            for x in range(3):
                edge[x, a] = points[corners[k, a + 1], x] - points[corners[k, 0], x]
        f = 0.0
        for x in range(3):
            for y in range(3):
                s = 0.0
                for a in range(3):
                    s += edge[x, a] * inverse[k, a, y]
                t[x, y] = s
                f += s * s
        for x in range(3):
            x1, x2 = (x + 1) % 3, (x + 2) % 3
            for y in range(3):
                y1, y2 = (y + 1) % 3, (y + 2) % 3
                cof[x, y] = t[x1, y1] * t[x2, y2] - t[x1, y2] * t[x2, y1]
        d = t[0, 0] * cof[0, 0] + t[0, 1] * cof[0, 1] + t[0, 2] * cof[0, 2]
        if e == 0.0 and d <= FLATTEST * size:
            return np.inf
        far = math.sqrt(d * d + e * e)
        h = 0.5 * (d + far) if d > 0.0 else 0.5 * e * e / (far - d)  # in place of d, above 0
        root, square = h ** (-2.0 / 3.0), d * d + size * size
        total += f * root / 3.0 + 0.5 * weight * square / (size * h)
        on_t = 2.0 * root / 3.0
        on_cof = -2.0 * f * root / (9.0 * far)
        on_cof += 0.5 * weight * (2.0 * d / h - square / (h * far)) / size
        for x in range(3):
            for y in range(3):
                p[x, y] = on_t * t[x, y] + on_cof * cof[x, y]
        for a in range(3):
            for x in range(3):
                g = p[x, 0] * inverse[k, a, 0] + p[x, 1] * inverse[k, a, 1]
                g += p[x, 2] * inverse[k, a, 2]
                gradient[corners[k, a + 1], x] += g
                gradient[corners[k, 0], x] -= g
    return total
