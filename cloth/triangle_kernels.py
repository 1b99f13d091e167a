"""The stretch of the triangles: compiled twins of ``cloth.reference``, as in ``cloth.kernels``."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.compiled import compiled


@compiled
def limited(
    first: float, second: float, penalty: float, tensile: float, compressive: float, poisson: float
) -> tuple[float, float]:
    """See ``cloth.reference.limited``. Without branches: see ``project_stretch``."""
    soft = 1.0 / (penalty + compressive)
    e, f = first - 1.0, second - 1.0
    both = penalty * (e + f) / (penalty + tensile / (1.0 - poisson))
    apart = penalty * (e - f) / (penalty + tensile / (1.0 + poisson))
    two = (compressive >= tensile) | (f >= 0.5 * (both - apart))
    one = e > 0.0
    pull = penalty * e / (penalty + tensile)
    narrowing = compressive * poisson * pull if one else 0.0
    a = pull if one else penalty * e * soft
    b = (penalty * f - narrowing) * soft
    return 1.0 + (0.5 * (both + apart) if two else a), 1.0 + (0.5 * (both - apart) if two else b)


@compiled
def project_stretch(
    square: Array, penalty: Array, tensile: Array, compressive: Array, poisson: float
) -> None:
    """Overwrite the square y^T y of the stretch asked for with the P of z = y P.

    P = V diag(sigma'/sigma) V^T. A loop without branches over few arrays of one dimension, which
    the compiler takes several triangles at a time.

    Parameters
    ----------
    square
        y^T y (3 m,) [-], three numbers xx, xy, yy a triangle; becomes P in the same order.
    penalty, tensile, compressive, poisson
        As in ``cloth.reference.limited``: the first three (m,) [N/m].
    """
    for t in range(len(penalty)):
        a, b, c = square[3 * t], square[3 * t + 1], square[3 * t + 2]
        mean, half = 0.5 * (a + c), 0.5 * (a - c)
        spread = math.sqrt(half * half + b * b)
        larger, smaller = mean + spread, mean - spread
        s1 = math.sqrt(larger if larger > 1e-12 else 1e-12)
        s2 = math.sqrt(smaller if smaller > 1e-12 else 1e-12)
        f1, f2 = limited(s1, s2, penalty[t], tensile[t], compressive[t], poisson)
        f1, f2 = f1 / s1, f2 / s2
        alike = spread <= 1e-14 * mean
        over = 1.0 / (1.0 if alike else spread)
        middle = f1 if alike else 0.5 * (f1 + f2)
        deviation = 0.0 if alike else 0.5 * (f1 - f2)
        cos2, sin2 = half * over, b * over
        square[3 * t] = middle + deviation * cos2
        square[3 * t + 1] = deviation * sin2
        square[3 * t + 2] = middle - deviation * cos2


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
    """Return ``project_stretch``'s P where the strain ``rest`` (3,) [-] is free of tension.

    U = 1 + rest + g of the g that ``limited`` leaves of sqrt(y^T y) - 1 - rest, and z = y P is the
    nearest to y of all with that U: P = U (U y^T y U)^(-1/2) U. ``a``, ``b``, ``c`` [-] are y^T y,
    as xx, xy, yy, and so is the result. See ``cloth.viscous``.
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
def _asked(
    x: Array,
    triangles: Ints,
    gradients: Array,
    relaxation: float,
    z: Array,
    u: Array,
    datum: float,
    slope: Array,
    square: Array,
    normal: Array,
    pressure: Array,
) -> float:
    """What ``triangle_step`` asks of every triangle: y into ``u``; returns the volume.

    ``square`` (3 m,) becomes y^T y, ``normal`` (m, 3) a third of the area vector, ``pressure``
    (m, 3) that at the corners.
    """
    over, volume = 1.0 - relaxation, 0.0
    s0, s1, s2 = slope
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t]
        i0, i1, i2 = x[i, 0], x[i, 1], x[i, 2]
        a0, a1, a2 = x[j, 0] - i0, x[j, 1] - i1, x[j, 2] - i2
        b0, b1, b2 = x[k, 0] - i0, x[k, 1] - i1, x[k, 2] - i2
        n0 = (a1 * b2 - a2 * b1) / 6.0
        n1 = (a2 * b0 - a0 * b2) / 6.0
        n2 = (a0 * b1 - a1 * b0) / 6.0
        normal[t, 0], normal[t, 1], normal[t, 2] = n0, n1, n2
        volume += i0 * n0 + i1 * n1 + i2 * n2
        pa = 0.25 * (s0 * a0 + s1 * a1 + s2 * a2)
        pb = 0.25 * (s0 * b0 + s1 * b1 + s2 * b2)
        pi = datum + s0 * i0 + s1 * i1 + s2 * i2 + pa + pb
        pressure[t, 0], pressure[t, 1], pressure[t, 2] = pi, pi + pa, pi + pb
        # F maps the moulded plane: the gradients of the three corners sum to zero.
        g1, h1 = relaxation * gradients[t, 1, 0], relaxation * gradients[t, 1, 1]
        g2, h2 = relaxation * gradients[t, 2, 0], relaxation * gradients[t, 2, 1]
        y00 = a0 * g1 + b0 * g2 + over * z[t, 0, 0] + u[t, 0, 0]
        y10 = a1 * g1 + b1 * g2 + over * z[t, 1, 0] + u[t, 1, 0]
        y20 = a2 * g1 + b2 * g2 + over * z[t, 2, 0] + u[t, 2, 0]
        y01 = a0 * h1 + b0 * h2 + over * z[t, 0, 1] + u[t, 0, 1]
        y11 = a1 * h1 + b1 * h2 + over * z[t, 1, 1] + u[t, 1, 1]
        y21 = a2 * h1 + b2 * h2 + over * z[t, 2, 1] + u[t, 2, 1]
        u[t, 0, 0], u[t, 0, 1], u[t, 1, 0] = y00, y01, y10
        u[t, 1, 1], u[t, 2, 0], u[t, 2, 1] = y11, y20, y21
        square[3 * t] = y00 * y00 + y10 * y10 + y20 * y20
        square[3 * t + 1] = y00 * y01 + y10 * y11 + y20 * y21
        square[3 * t + 2] = y01 * y01 + y11 * y11 + y21 * y21
    return volume


@compiled
def _pull(
    gradients: Array,
    areas: Array,
    penalty: Array,
    square: Array,
    normal: Array,
    pressure: Array,
    z: Array,
    u: Array,
    force: Array,
) -> None:
    """From y in ``u`` to z = y P and u = y - z; ``force`` (m, 3, 3) [N] on the corners."""
    for t in range(len(areas)):
        p, q, s = square[3 * t], square[3 * t + 1], square[3 * t + 2]
        weight = penalty[t] * areas[t]
        g1, h1 = weight * gradients[t, 1, 0], weight * gradients[t, 1, 1]
        g2, h2 = weight * gradients[t, 2, 0], weight * gradients[t, 2, 1]
        for d in range(3):
            v, w, n = u[t, d, 0], u[t, d, 1], normal[t, d]
            z0, z1 = v * p + w * q, v * q + w * s
            z[t, d, 0], z[t, d, 1] = z0, z1
            u[t, d, 0], u[t, d, 1] = v - z0, w - z1
            w0, w1 = 2.0 * z0 - v, 2.0 * z1 - w
            second, third = w0 * g1 + w1 * h1, w0 * g2 + w1 * h2
            force[t, 0, d] = pressure[t, 0] * n - second - third
            force[t, 1, d] = pressure[t, 1] * n + second
            force[t, 2, d] = pressure[t, 2] * n + third


@compiled
def _collect(
    starts: Ints, corners: Ints, free: Bools, normal: Array, force: Array, gradient: Array,
    rhs: Array,
) -> None:  # fmt: skip
    """Add to ``rhs`` what acts on the nodes' corners, and sum their normals into ``gradient``."""
    for i in range(len(free)):
        g0, g1, g2, f0, f1, f2 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for r in range(starts[i], starts[i + 1]):
            t, c = corners[r, 0], corners[r, 1]
            g0, g1, g2 = g0 + normal[t, 0], g1 + normal[t, 1], g2 + normal[t, 2]
            f0, f1, f2 = f0 + force[t, c, 0], f1 + force[t, c, 1], f2 + force[t, c, 2]
        rhs[i, 0], rhs[i, 1], rhs[i, 2] = rhs[i, 0] + f0, rhs[i, 1] + f1, rhs[i, 2] + f2
        on = 1.0 if free[i] else 0.0
        gradient[i, 0], gradient[i, 1], gradient[i, 2] = on * g0, on * g1, on * g2


@compiled
def triangle_step(
    x: Array,
    triangles: Ints,
    starts: Ints,
    corners: Ints,
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
    m = triangles.shape[0]
    square, normal, pressure = np.empty(3 * m), np.empty((m, 3)), np.empty((m, 3))
    force = np.empty((m, 3, 3))
    volume = _asked(
        x, triangles, gradients, relaxation, z, u, datum, slope, square, normal, pressure
    )
    if len(rest) == 0:
        project_stretch(square, penalty, tensile, compressive, poisson)
    for t in range(len(rest)):
        square[3 * t], square[3 * t + 1], square[3 * t + 2] = project_shifted(
            square[3 * t], square[3 * t + 1], square[3 * t + 2], rest[t],
            penalty[t], tensile[t], compressive[t], poisson,
        )  # fmt: skip
    _pull(gradients, areas, penalty, square, normal, pressure, z, u, force)
    _collect(starts, corners, free, normal, force, gradient, rhs)
    return volume
