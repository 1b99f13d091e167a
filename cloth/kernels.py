"""The compiled twins of ``cloth.reference``: same names, same arguments, same answers.

Arrays named in a docstring there as changed are changed in place here.
"""

from __future__ import annotations

import math

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled


@compiled
def limited(
    first: float, second: float, penalty: float, tensile: float, compressive: float, poisson: float
) -> tuple[float, float]:
    """See ``cloth.reference.limited``."""
    soft = 1.0 / (penalty + compressive)
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
    if compressive == 0.0 and s1 <= 1.0:
        return 1.0, 0.0, 1.0
    f1, f2 = limited(s1, s2, penalty, tensile, compressive, poisson)
    f1, f2 = f1 / max(s1, 1e-6), f2 / s2
    if spread <= 1e-14 * mean:
        return f1, 0.0, f1
    cos2, sin2 = half / spread, b / spread
    middle, deviation = 0.5 * (f1 + f2), 0.5 * (f1 - f2)
    return middle + deviation * cos2, deviation * sin2, middle - deviation * cos2


@compiled
def project_shifted(
    a: float,
    b: float,
    c: float,
    rest: Array,
    penalty: float,
    tensile: float,
    compressive: float,
    poisson: float,
) -> tuple[float, float, float]:
    """The same of a sheet free of tension at the strain ``rest`` (3,): see ``cloth.viscous``.

    U = 1 + rest + g of the g that ``limited`` leaves of sqrt(y^T y) - 1 - rest, and z = y P is the
    nearest to y of all with that U: P = U (U y^T y U)^(-1/2) U.
    """
    root = math.sqrt(max(a * c - b * b, 1e-24))
    size = math.sqrt(a + c + 2.0 * root)
    g, h, k = (a + root) / size - rest[0], b / size - rest[1], (c + root) / size - rest[2]
    mean, half = 0.5 * (g + k), 0.5 * (g - k)
    spread = math.sqrt(half * half + h * h)
    first, second = limited(mean + spread, mean - spread, penalty, tensile, compressive, poisson)
    middle, deviation = 0.5 * (first + second), 0.5 * (first - second)
    cos2, sin2 = 1.0, 0.0
    if spread > 1e-14 * abs(mean):
        cos2, sin2 = half / spread, h / spread
    p, q = middle + deviation * cos2 + rest[0], deviation * sin2 + rest[1]
    s = middle - deviation * cos2 + rest[2]
    # U y^T y U, and the inverse of its root by its trace and determinant.
    d, e, f, g = a * p + b * q, a * q + b * s, b * p + c * q, b * q + c * s
    a, b, c = p * d + q * f, p * e + q * g, q * e + s * g
    root = math.sqrt(max(a * c - b * b, 1e-24))
    scale = 1.0 / (root * math.sqrt(a + c + 2.0 * root))
    a, b, c = scale * (c + root), -scale * b, scale * (a + root)
    d, e, f, g = a * p + b * q, a * q + b * s, b * p + c * q, b * q + c * s
    return p * d + q * f, p * e + q * g, q * e + s * g


@compiled
def triangle_step(
    x: Array,
    triangles: Ints,
    gradients: Array,
    areas: Array,
    penalty: Array,
    relaxation: float,
    tensile: Array,
    compressive: Array,
    poisson: float,
    rest: Array,
    z: Array,
    u: Array,
    datum: float,
    slope: Array,
    free: Bools,
    gradient: Array,
    rhs: Array,
) -> float:
    """See ``cloth.reference.triangle_step``."""
    over, volume, shifted = 1.0 - relaxation, 0.0, len(rest) > 0
    s0, s1, s2 = slope
    gradient[:] = 0.0
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        i0, i1, i2 = x[i, 0], x[i, 1], x[i, 2]
        a0, a1, a2 = x[j, 0] - i0, x[j, 1] - i1, x[j, 2] - i2
        b0, b1, b2 = x[k, 0] - i0, x[k, 1] - i1, x[k, 2] - i2
        # F maps the moulded plane: the gradients of the three corners sum to zero.
        g1, h1 = relaxation * gradients[t, 1, 0], relaxation * gradients[t, 1, 1]
        g2, h2 = relaxation * gradients[t, 2, 0], relaxation * gradients[t, 2, 1]
        y00 = a0 * g1 + b0 * g2 + over * z[t, 0, 0] + u[t, 0, 0]
        y10 = a1 * g1 + b1 * g2 + over * z[t, 1, 0] + u[t, 1, 0]
        y20 = a2 * g1 + b2 * g2 + over * z[t, 2, 0] + u[t, 2, 0]
        y01 = a0 * h1 + b0 * h2 + over * z[t, 0, 1] + u[t, 0, 1]
        y11 = a1 * h1 + b1 * h2 + over * z[t, 1, 1] + u[t, 1, 1]
        y21 = a2 * h1 + b2 * h2 + over * z[t, 2, 1] + u[t, 2, 1]
        a = y00 * y00 + y10 * y10 + y20 * y20
        b = y00 * y01 + y10 * y11 + y20 * y21
        c = y01 * y01 + y11 * y11 + y21 * y21
        pull, push = tensile[t], compressive[t]
        if shifted:
            p, q, s = project_shifted(a, b, c, rest[t], penalty[t], pull, push, poisson)
        else:
            p, q, s = project_stretch(a, b, c, penalty[t], pull, push, poisson)
        n0 = (a1 * b2 - a2 * b1) / 6.0
        n1 = (a2 * b0 - a0 * b2) / 6.0
        n2 = (a0 * b1 - a1 * b0) / 6.0
        volume += i0 * n0 + i1 * n1 + i2 * n2
        pa = 0.25 * (s0 * a0 + s1 * a1 + s2 * a2)
        pb = 0.25 * (s0 * b0 + s1 * b1 + s2 * b2)
        pi = datum + s0 * i0 + s1 * i1 + s2 * i2 + pa + pb
        weight = penalty[t] * areas[t] / relaxation
        for d, v, w, n in ((0, y00, y01, n0), (1, y10, y11, n1), (2, y20, y21, n2)):
            z0, z1 = v * p + w * q, v * q + w * s
            z[t, d, 0], z[t, d, 1] = z0, z1
            u[t, d, 0], u[t, d, 1] = v - z0, w - z1
            w0, w1 = weight * (2.0 * z0 - v), weight * (2.0 * z1 - w)
            second, third = w0 * g1 + w1 * h1, w0 * g2 + w1 * h2
            rhs[i, d] += pi * n - second - third
            rhs[j, d] += (pi + pa) * n + second
            rhs[k, d] += (pi + pb) * n + third
            gradient[i, d] += n
            gradient[j, d] += n
            gradient[k, d] += n
    _hold(free, gradient)
    return volume


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
