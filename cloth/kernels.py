"""The compiled twins of ``cloth.reference``: same names, same arguments, same answers.

Arrays named in a docstring there as changed are changed in place here.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled


@compiled
def softened(stretch: float, penalty: float, tensile: float, compressive: float) -> float:
    """See ``cloth.reference.softened``."""
    if stretch > 1.0:
        if tensile < 0.0:
            return 1.0
        return (penalty * stretch + tensile) / (penalty + tensile)
    return (penalty * stretch + compressive) / (penalty + compressive)


@compiled
def project_stretch(
    y: Array, penalty: float, tensile: float, compressive: float
) -> tuple[float, float, float]:
    """Entries (p, q, s) of the symmetric P with z = y P: V diag(sigma'/sigma) V^T."""
    a = y[0, 0] * y[0, 0] + y[1, 0] * y[1, 0] + y[2, 0] * y[2, 0]
    b = y[0, 0] * y[0, 1] + y[1, 0] * y[1, 1] + y[2, 0] * y[2, 1]
    c = y[0, 1] * y[0, 1] + y[1, 1] * y[1, 1] + y[2, 1] * y[2, 1]
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    spread = math.sqrt(half * half + b * b)
    s1 = math.sqrt(mean + spread)
    s2 = math.sqrt(max(mean - spread, 1e-12))
    f1 = softened(s1, penalty, tensile, compressive) / max(s1, 1e-6)
    f2 = softened(s2, penalty, tensile, compressive) / s2
    if spread <= 1e-14 * mean:
        return f1, 0.0, f1
    cos2, sin2 = half / spread, b / spread
    middle, deviation = 0.5 * (f1 + f2), 0.5 * (f1 - f2)
    return middle + deviation * cos2, deviation * sin2, middle - deviation * cos2


@compiled
def membrane_step(
    x: Array,
    triangles: Ints,
    gradients: Array,
    areas: Array,
    penalty: Array,
    relaxation: float,
    tensile: float,
    compressive: float,
    z: Array,
    u: Array,
    rhs: Array,
) -> None:
    """See ``cloth.reference.membrane_step``."""
    y = np.empty((3, 2))
    for t in range(triangles.shape[0]):
        g = gradients[t]
        for d in range(3):
            for e in range(2):
                f = 0.0
                for i in range(3):
                    f += x[triangles[t, i], d] * g[i, e]
                y[d, e] = relaxation * f + (1.0 - relaxation) * z[t, d, e] + u[t, d, e]
        p, q, s = project_stretch(y, penalty[t], tensile, compressive)
        weight = penalty[t] * areas[t]
        for d in range(3):
            z0, z1 = y[d, 0] * p + y[d, 1] * q, y[d, 0] * q + y[d, 1] * s
            z[t, d, 0], z[t, d, 1] = z0, z1
            u[t, d, 0], u[t, d, 1] = y[d, 0] - z0, y[d, 1] - z1
            w0, w1 = weight * (2.0 * z0 - y[d, 0]), weight * (2.0 * z1 - y[d, 1])
            for i in range(3):
                rhs[triangles[t, i], d] += w0 * g[i, 0] + w1 * g[i, 1]


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


@compiled
def contact_step(
    x: Array, limit: Array, weight: Array, relaxation: float, z: Array, u: Array, rhs: Array
) -> None:
    """See ``cloth.reference.contact_step``."""
    for i in range(x.shape[0]):
        if weight[i] <= 0.0:
            continue
        y0 = relaxation * x[i, 0] + (1.0 - relaxation) * z[i, 0] + u[i, 0]
        y1 = relaxation * x[i, 1] + (1.0 - relaxation) * z[i, 1] + u[i, 1]
        y2 = relaxation * x[i, 2] + (1.0 - relaxation) * z[i, 2] + u[i, 2]
        radius = math.sqrt(y0 * y0 + y1 * y1 + y2 * y2)
        scale = min(1.0, limit[i] / max(radius, 1e-30))
        z[i, 0], z[i, 1], z[i, 2] = scale * y0, scale * y1, scale * y2
        u[i, 0], u[i, 1], u[i, 2] = y0 - z[i, 0], y1 - z[i, 1], y2 - z[i, 2]
        for d in range(3):
            rhs[i, d] += weight[i] * (z[i, d] - u[i, d])


@compiled
def volume_and_loads(
    x: Array, triangles: Ints, slope: Array, free: Bools, gradient: Array, hydrostatic: Array
) -> float:
    """See ``cloth.reference.volume_and_loads``; fills the last two and returns the volume."""
    gradient[:] = 0.0
    hydrostatic[:] = 0.0
    volume = 0.0
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        a0, a1, a2 = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        b0, b1, b2 = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        n0 = (a1 * b2 - a2 * b1) / 6.0
        n1 = (a2 * b0 - a0 * b2) / 6.0
        n2 = (a0 * b1 - a1 * b0) / 6.0
        volume += x[i, 0] * n0 + x[i, 1] * n1 + x[i, 2] * n2
        pi = slope[0] * x[i, 0] + slope[1] * x[i, 1] + slope[2] * x[i, 2]
        pj = slope[0] * x[j, 0] + slope[1] * x[j, 1] + slope[2] * x[j, 2]
        pk = slope[0] * x[k, 0] + slope[1] * x[k, 1] + slope[2] * x[k, 2]
        total = pi + pj + pk
        for node, own in ((i, pi), (j, pj), (k, pk)):
            if free[node]:
                p = 0.25 * (total + own)
                gradient[node, 0] += n0
                gradient[node, 1] += n1
                gradient[node, 2] += n2
                hydrostatic[node, 0] += p * n0
                hydrostatic[node, 1] += p * n1
                hydrostatic[node, 2] += p * n2
    return volume


@compiled
def bending_rest_step(
    x: Array, nodes: Ints, coefficients: Array, moment: Array, rhs: Array
) -> None:
    """See ``cloth.reference.bending_rest_step``."""
    for h in range(nodes.shape[0]):
        i, j, k, m = nodes[h]
        e0, e1, e2 = x[j, 0] - x[i, 0], x[j, 1] - x[i, 1], x[j, 2] - x[i, 2]
        a0, a1, a2 = x[k, 0] - x[i, 0], x[k, 1] - x[i, 1], x[k, 2] - x[i, 2]
        b0, b1, b2 = x[m, 0] - x[i, 0], x[m, 1] - x[i, 1], x[m, 2] - x[i, 2]
        p0, p1, p2 = e1 * a2 - e2 * a1, e2 * a0 - e0 * a2, e0 * a1 - e1 * a0
        q0, q1, q2 = b1 * e2 - b2 * e1, b2 * e0 - b0 * e2, b0 * e1 - b1 * e0
        p = 1.0 / max(math.sqrt(p0 * p0 + p1 * p1 + p2 * p2), 1e-30)
        q = 1.0 / max(math.sqrt(q0 * q0 + q1 * q1 + q2 * q2), 1e-30)
        n0, n1, n2 = p0 * p + q0 * q, p1 * p + q1 * q, p2 * p + q2 * q
        scale = moment[h] / max(math.sqrt(n0 * n0 + n1 * n1 + n2 * n2), 1e-12)
        for s in range(4):
            node, w = nodes[h, s], scale * coefficients[h, s]
            rhs[node, 0] += w * n0
            rhs[node, 1] += w * n1
            rhs[node, 2] += w * n2


@compiled
def normal_drag_step(x: Array, anchor: Array, gradient: Array, drag: Array, rhs: Array) -> None:
    """See ``cloth.reference.normal_drag_step``."""
    for i in range(x.shape[0]):
        g0, g1, g2 = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        square = g0 * g0 + g1 * g1 + g2 * g2
        if square <= 0.0 or drag[i] <= 0.0:
            continue
        d = g0 * (x[i, 0] - anchor[i, 0])
        d += g1 * (x[i, 1] - anchor[i, 1]) + g2 * (x[i, 2] - anchor[i, 2])
        d *= drag[i] / square
        rhs[i, 0] += d * g0
        rhs[i, 1] += d * g1
        rhs[i, 2] += d * g2
