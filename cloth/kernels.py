"""The compiled twins of ``cloth.reference``: same names, same arguments, same answers.

Arrays named in a docstring there as changed are changed in place here.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled


@compiled
def limited(
    first: float, second: float, penalty: float, tensile: float, compressive: float, poisson: float
) -> tuple[float, float]:
    """See ``cloth.reference.limited``."""
    soft = 1.0 / (penalty + compressive)
    if tensile < 0.0:
        a = min(1.0, (penalty * first + compressive) * soft) if first < 1.0 else 1.0
        b = min(1.0, (penalty * second + compressive) * soft) if second < 1.0 else 1.0
        return a, b
    e, f = first - 1.0, second - 1.0
    both = penalty * (e + f) / (penalty + tensile / (1.0 - poisson))
    apart = penalty * (e - f) / (penalty + tensile / (1.0 + poisson))
    if compressive >= tensile or f >= 0.5 * (both - apart):
        return 1.0 + 0.5 * (both + apart), 1.0 + 0.5 * (both - apart)
    if e > 0.0:
        a = penalty * e / (penalty + tensile)
        return 1.0 + a, 1.0 + (penalty * f - compressive * poisson * a) * soft
    return 1.0 + penalty * e * soft, 1.0 + penalty * f * soft


@compiled
def project_stretch(
    a: float, b: float, c: float, penalty: float, tensile: float, compressive: float, poisson: float
) -> tuple[float, float, float]:
    """Entries (p, q, s) of the symmetric P with z = y P: V diag(sigma'/sigma) V^T.

    ``a``, ``b``, ``c``: y^T y = [[a, b], [b, c]].
    """
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    spread = math.sqrt(half * half + b * b)
    s1 = math.sqrt(mean + spread)
    s2 = math.sqrt(max(mean - spread, 1e-12))
    if tensile < 0.0 and compressive == 0.0 and s1 <= 1.0:
        return 1.0, 0.0, 1.0
    f1, f2 = limited(s1, s2, penalty, tensile, compressive, poisson)
    f1, f2 = f1 / max(s1, 1e-6), f2 / s2
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
    tensile: Array,
    compressive: Array,
    poisson: float,
    z: Array,
    u: Array,
    rhs: Array,
) -> None:
    """See ``cloth.reference.membrane_step``."""
    rest = 1.0 - relaxation
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        g0, h0 = relaxation * gradients[t, 0, 0], relaxation * gradients[t, 0, 1]
        g1, h1 = relaxation * gradients[t, 1, 0], relaxation * gradients[t, 1, 1]
        g2, h2 = relaxation * gradients[t, 2, 0], relaxation * gradients[t, 2, 1]
        y00 = x[i, 0] * g0 + x[j, 0] * g1 + x[k, 0] * g2 + rest * z[t, 0, 0] + u[t, 0, 0]
        y10 = x[i, 1] * g0 + x[j, 1] * g1 + x[k, 1] * g2 + rest * z[t, 1, 0] + u[t, 1, 0]
        y20 = x[i, 2] * g0 + x[j, 2] * g1 + x[k, 2] * g2 + rest * z[t, 2, 0] + u[t, 2, 0]
        y01 = x[i, 0] * h0 + x[j, 0] * h1 + x[k, 0] * h2 + rest * z[t, 0, 1] + u[t, 0, 1]
        y11 = x[i, 1] * h0 + x[j, 1] * h1 + x[k, 1] * h2 + rest * z[t, 1, 1] + u[t, 1, 1]
        y21 = x[i, 2] * h0 + x[j, 2] * h1 + x[k, 2] * h2 + rest * z[t, 2, 1] + u[t, 2, 1]
        p, q, s = project_stretch(
            y00 * y00 + y10 * y10 + y20 * y20,
            y00 * y01 + y10 * y11 + y20 * y21,
            y01 * y01 + y11 * y11 + y21 * y21,
            penalty[t],
            tensile[t],
            compressive[t],
            poisson,
        )
        weight = penalty[t] * areas[t] / relaxation
        for d, a, b in ((0, y00, y01), (1, y10, y11), (2, y20, y21)):
            z0, z1 = a * p + b * q, a * q + b * s
            z[t, d, 0], z[t, d, 1] = z0, z1
            u[t, d, 0], u[t, d, 1] = a - z0, b - z1
            w0, w1 = weight * (2.0 * z0 - a), weight * (2.0 * z1 - b)
            rhs[i, d] += w0 * g0 + w1 * h0
            rhs[j, d] += w0 * g1 + w1 * h1
            rhs[k, d] += w0 * g2 + w1 * h2


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
    s0, s1, s2 = slope
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        x0, x1, x2 = x[i, 0], x[i, 1], x[i, 2]
        a0, a1, a2 = x[j, 0] - x0, x[j, 1] - x1, x[j, 2] - x2
        b0, b1, b2 = x[k, 0] - x0, x[k, 1] - x1, x[k, 2] - x2
        n0 = (a1 * b2 - a2 * b1) / 6.0
        n1 = (a2 * b0 - a0 * b2) / 6.0
        n2 = (a0 * b1 - a1 * b0) / 6.0
        volume += x0 * n0 + x1 * n1 + x2 * n2
        pi = s0 * x0 + s1 * x1 + s2 * x2
        pa = s0 * a0 + s1 * a1 + s2 * a2
        pb = s0 * b0 + s1 * b1 + s2 * b2
        common = pi + 0.25 * (pa + pb)
        for node, p in ((i, common), (j, common + 0.25 * pa), (k, common + 0.25 * pb)):
            gradient[node, 0] += n0
            gradient[node, 1] += n1
            gradient[node, 2] += n2
            hydrostatic[node, 0] += p * n0
            hydrostatic[node, 1] += p * n1
            hydrostatic[node, 2] += p * n2
    for node in range(x.shape[0]):
        if not free[node]:
            gradient[node, :] = 0.0
            hydrostatic[node, :] = 0.0
    return volume


@compiled
def bending_rest_step(
    gradient: Array, starts: Ints, columns: Ints, values: Array, moment: Array, rhs: Array
) -> None:
    """See ``cloth.reference.bending_rest_step``."""
    for i in range(moment.shape[0]):
        g0, g1, g2 = gradient[i, 0], gradient[i, 1], gradient[i, 2]
        square = g0 * g0 + g1 * g1 + g2 * g2
        if square <= 0.0:
            continue
        scale = moment[i] / math.sqrt(square)
        g0, g1, g2 = scale * g0, scale * g1, scale * g2
        for p in range(starts[i], starts[i + 1]):
            j, w = columns[p], values[p]
            rhs[j, 0] += w * g0
            rhs[j, 1] += w * g1
            rhs[j, 2] += w * g2


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


@compiled
def shorten_step(
    x: Array, triangles: Ints, gradients: Array, mobility: Array, limit: float
) -> float:
    """See ``cloth.reference.shorten_step``."""
    worst = 0.0
    f = np.empty((3, 2))
    for t in range(triangles.shape[0]):
        a, b, c = 0.0, 0.0, 0.0
        for d in range(3):
            f0, f1 = 0.0, 0.0
            for i in range(3):
                v = x[triangles[t, i], d]
                f0 += v * gradients[t, i, 0]
                f1 += v * gradients[t, i, 1]
            f[d, 0], f[d, 1] = f0, f1
            a += f0 * f0
            b += f0 * f1
            c += f1 * f1
        mean, half = 0.5 * (a + c), 0.5 * (a - c)
        spread = math.sqrt(half * half + b * b)
        stretch = math.sqrt(mean + spread)
        excess = stretch - 1.0 - limit
        worst = max(worst, excess)
        if not excess > 0.0:
            continue
        cosine = math.sqrt(max(0.0, 0.5 + 0.5 * half / spread)) if spread > 0.0 else 1.0
        sine = math.copysign(math.sqrt(max(0.0, 1.0 - cosine * cosine)), b)
        ease = 0.0
        for i in range(3):
            along = gradients[t, i, 0] * cosine + gradients[t, i, 1] * sine
            ease += mobility[triangles[t, i]] * along * along
        if ease <= 0.0:
            continue
        for i in range(3):
            along = gradients[t, i, 0] * cosine + gradients[t, i, 1] * sine
            move = excess / ease * mobility[triangles[t, i]] * along / stretch
            for d in range(3):
                x[triangles[t, i], d] -= move * (f[d, 0] * cosine + f[d, 1] * sine)
    return worst
