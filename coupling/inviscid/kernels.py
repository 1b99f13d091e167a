"""Integrals of the ball's Neumann function over panels, compiled.

    4 pi G(x, y) = 1/r + 1/s + 1/R log(2 R^2 / (R^2 - x.y + R s)),
    r = |x - y|,  s^2 = R^2 - 2 x.y + |x|^2 |y|^2 / R^2,

whose derivative along the normal is -1/(4 pi R^2) all over the sphere |y| = R. s is the distance
to the mirror image, scaled. Without a sphere only 1/r is left. A point that stands for the area a
is a disc of radius b = sqrt(a / pi): below r = b its distance counts as (b + r^2/b)/2, which gives
the disc's own potential at its centre and never much more than the solid angle 2 pi beside it.
"""

from __future__ import annotations

import math

import numpy as np

from cloth.compiled import compiled
from coupling.ports import AnyArray, Array, Ints

PER_SPHERE = 1.0 / (4.0 * math.pi)
TINY = 1e-8  # side over R of what a collapsed face counts as


@compiled
def rounded(squared: float, disc: float) -> float:
    """The distance whose square is ``squared`` [m^2], rounded off within a disc's radius [m]."""
    if squared < disc * disc:
        return 0.5 * (disc + squared / disc)
    return math.sqrt(squared)


@compiled
def image(
    xx: float, xy: float, yy: float, nx: float, ny: float, disc: float, radius: float
) -> tuple[float, float]:
    """What the wall adds to G, and its derivative along n [times n's length], both times 4 pi.

    ``xx`` ... are the scalar products of x, y and n; n is the normal at y.
    """
    ratio = xx / (radius * radius)
    s = rounded(max(radius * radius - 2.0 * xy + ratio * yy, 0.0), disc)
    inverse = 1.0 / s
    reach = radius * radius - xy + radius * s
    slope = (ratio * ny - nx) * inverse
    value = inverse + math.log(2.0 * radius * radius / reach) / radius
    return value, -slope * inverse * inverse - (slope - nx / radius) / reach


@compiled
def panel_integrals(
    x: Array, points: Array, areas: Array, radius: float, least: float, free: bool
) -> tuple[float, float]:
    """Integrals of G and of dG/dn over a panel (Q, 3), seen from ``x`` (3,), times 4 pi.

    Without ``free`` only the wall's part; without a sphere, ``radius`` 0, only the free part.
    ``least`` [m^4] is the square of the area added to each of ``areas`` (Q, 3), for collapsed ones.
    """
    x0, x1, x2 = x[0], x[1], x[2]
    xx = x0 * x0 + x1 * x1 + x2 * x2
    single, double = 0.0, 0.0
    for k in range(points.shape[0]):
        y0, y1, y2 = points[k, 0], points[k, 1], points[k, 2]
        n0, n1, n2 = areas[k, 0], areas[k, 1], areas[k, 2]
        area = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2 + least)
        disc = math.sqrt(area / math.pi)
        nx, ny = n0 * x0 + n1 * x1 + n2 * x2, n0 * y0 + n1 * y1 + n2 * y2
        if free:
            d0, d1, d2 = x0 - y0, x1 - y1, x2 - y2
            inverse = 1.0 / rounded(d0 * d0 + d1 * d1 + d2 * d2, disc)
            single += area * inverse
            double += (nx - ny) * inverse * inverse * inverse
        if radius > 0.0:
            xy, yy = x0 * y0 + x1 * y1 + x2 * y2, y0 * y0 + y1 * y1 + y2 * y2
            value, slope = image(xx, xy, yy, nx, ny, disc, radius)
            single += area * value
            double += slope
    return single, double


@compiled
def own_potential(corners: Array, x: Array) -> float:
    """Integral of 1/r over the fan of triangles from ``x`` (3,) to ``corners`` (k, 3) [m].

    Exact: a triangle with a corner at x and the opposite edge ab of length L has
    |a x b|/L log((|a| + |b| + L)/(|a| + |b| - L)).
    """
    total = 0.0
    count = corners.shape[0]
    for k in range(count):
        a, b = corners[k] - x, corners[(k + 1) % count] - x
        c0 = a[1] * b[2] - a[2] * b[1]
        c1 = a[2] * b[0] - a[0] * b[2]
        c2 = a[0] * b[1] - a[1] * b[0]
        double_area = math.sqrt(c0 * c0 + c1 * c1 + c2 * c2)
        e = b - a
        edge = math.sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2])
        sides = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]) + math.sqrt(
            b[0] * b[0] + b[1] * b[1] + b[2] * b[2]
        )
        if double_area > 1e-12 * edge * sides:
            total += double_area / edge * math.log((sides + edge) / (sides - edge))
    return total


@compiled
def least_square(points: Array, radius: float) -> float:
    """Square [m^4] of the area of a collapsed face: ``TINY`` times the size of the liquid."""
    size = radius
    if radius <= 0.0:
        for p in range(points.shape[0]):
            for d in range(3):
                size = max(size, abs(points[p, d]))
    return (TINY * size) ** 4


@compiled
def influence(
    points: Array,
    faces: Ints,
    centres: Array,
    coarse: Array,
    coarse_areas: Array,
    fine: Array,
    fine_areas: Array,
    touching: AnyArray,
    radius: float,
    row_sum: float,
    single: Array,
    double: Array,
) -> None:
    """Fill ``single`` and ``double`` (F, F): means of G, integrals of dG/dn over face j from i.

    ``points`` (p, 3), ``faces`` (F, k), their ``centres`` (F, 3), the samples of both rules, which
    faces are ``touching`` (F, F); the rows of ``double`` sum to ``row_sum``, by its diagonal.
    """
    count = faces.shape[0]
    least = least_square(points, radius)
    own = 2.0 * math.sqrt(math.pi * fine.shape[1]) * least**0.25
    size = np.zeros(count)
    for j in range(count):
        for k in range(fine_areas.shape[1]):
            n = fine_areas[j, k]
            size[j] += math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + least)
    for i in range(count):
        x = centres[i]
        total = 0.0
        for j in range(count):
            if touching[i, j]:
                s, d = panel_integrals(x, fine[j], fine_areas[j], radius, least, i != j)
            else:
                s, d = panel_integrals(x, coarse[j], coarse_areas[j], radius, least, True)
            if i == j:
                s += own_potential(points[faces[i]], x) + own
            single[i, j] = PER_SPHERE * s / size[j]
            double[i, j] = PER_SPHERE * d
            if i != j:
                total += PER_SPHERE * d
        double[i, i] = row_sum - total
