"""The compiled twins of ``cloth.reference``: same names, same arguments, same answers.

Arrays named in a docstring there as changed are changed in place here.
"""

from __future__ import annotations

import math

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled


@compiled
def _hold(free: Bools, gradient: Array) -> None:
    """Zero on nodes that are not ``free``."""
    for node in range(gradient.shape[0]):
        if not free[node]:
            gradient[node, 0] = gradient[node, 1] = gradient[node, 2] = 0.0


@compiled
def volume_and_gradient(x: Array, triangles: Ints, free: Bools, gradient: Array) -> float:
    """See ``cloth.reference.volume_and_gradient``."""
    gradient[:] = 0.0
    volume = 0.0
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        i0, i1, i2 = x[i, 0], x[i, 1], x[i, 2]
        a0, a1, a2 = x[j, 0] - i0, x[j, 1] - i1, x[j, 2] - i2
        b0, b1, b2 = x[k, 0] - i0, x[k, 1] - i1, x[k, 2] - i2
        n0 = (a1 * b2 - a2 * b1) / 6.0
        n1 = (a2 * b0 - a0 * b2) / 6.0
        n2 = (a0 * b1 - a1 * b0) / 6.0
        volume += i0 * n0 + i1 * n1 + i2 * n2
        for node in (i, j, k):
            gradient[node, 0] += n0
            gradient[node, 1] += n1
            gradient[node, 2] += n2
    _hold(free, gradient)
    return volume


@compiled
def triangle_strains(x: Array, triangles: Ints, gradients: Array, strain: Array) -> None:
    """See ``cloth.reference.triangle_strains``."""
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        g1, h1 = gradients[t, 1, 0], gradients[t, 1, 1]
        g2, h2 = gradients[t, 2, 0], gradients[t, 2, 1]
        a, b, c = 0.0, 0.0, 0.0
        for d in range(3):
            first, second = x[j, d] - x[i, d], x[k, d] - x[i, d]
            v, w = first * g1 + second * g2, first * h1 + second * h2
            a, b, c = a + v * v, b + v * w, c + w * w
        root = math.sqrt(max(a * c - b * b, 0.0))
        size = math.sqrt(max(a + c + 2.0 * root, 1e-300))
        strain[t, 0], strain[t, 1] = (a + root) / size - 1.0, b / size
        strain[t, 2] = (c + root) / size - 1.0


@compiled
def principal_strains(x: Array, triangles: Ints, gradients: Array, strain: Array) -> float:
    """See ``cloth.reference.principal_strains``; fills ``strain`` and returns its maximum."""
    worst = -1.0
    for t in range(triangles.shape[0]):
        a, b, c = 0.0, 0.0, 0.0
        for d in range(3):
            f0, f1 = 0.0, 0.0
            for i in range(3):
                v = x[triangles[t, i], d]
                f0 += v * gradients[t, i, 0]
                f1 += v * gradients[t, i, 1]
            a += f0 * f0
            b += f0 * f1
            c += f1 * f1
        mean, half = 0.5 * (a + c), 0.5 * (a - c)
        strain[t] = math.sqrt(mean + math.sqrt(half * half + b * b)) - 1.0
        worst = max(worst, strain[t])
    return worst
