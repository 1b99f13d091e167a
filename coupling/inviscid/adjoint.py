"""Derivatives of the panel integrals by all points that they are made of, compiled.

What is differentiated is E = sum_ij (s_ij S_ij + d_ij K_ij) at fixed s and d, with S and K as
``kernels.influence`` fills them.
"""

from __future__ import annotations

import math

from cloth.compiled import compiled
from coupling.inviscid.kernels import PER_SPHERE
from coupling.ports import AnyArray, Array


@compiled
def rounded_slopes(squared: float, disc: float) -> tuple[float, float, float]:
    """``kernels.rounded`` and its derivatives by the square and by the disc's radius."""
    if squared < disc * disc:
        ratio = squared / (disc * disc)
        return 0.5 * disc * (1.0 + ratio), 0.5 / disc, 0.5 * (1.0 - ratio)
    distance = math.sqrt(squared)
    return distance, 0.5 / distance, 0.0


@compiled
def image_slopes(
    xx: float,
    xy: float,
    yy: float,
    nx: float,
    ny: float,
    disc: float,
    radius: float,
    single: float,
    double: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Derivatives of ``single`` times value plus ``double`` times slope of ``kernels.image``.

    By xx, xy, yy, nx, ny and disc; the value itself comes last.
    """
    square = radius * radius
    ratio = xx / square
    squared = square - 2.0 * xy + ratio * yy
    s, by_squared, by_disc = rounded_slopes(max(squared, 0.0), disc)
    if squared <= 0.0:
        by_squared = 0.0
    inverse, reach = 1.0 / s, square - xy + radius * s
    u = ratio * ny - nx
    t, per_reach = u * inverse, 1.0 / reach
    value = inverse + math.log(2.0 * square * per_reach) / radius
    by_u = -double * inverse * (inverse * inverse + per_reach)
    by_reach = per_reach * (double * (t - nx / radius) * per_reach - single / radius)
    by_s = inverse * inverse * (double * t * (3.0 * inverse + s * per_reach) - single)
    by_s += radius * by_reach
    through = by_s * by_squared
    by_ratio = yy * through + by_u * ny
    return (
        by_ratio / square,
        -by_reach - 2.0 * through,
        ratio * through,
        double * per_reach / radius - by_u,
        by_u * ratio,
        by_s * by_disc,
        value,
    )


@compiled
def panel_slopes(
    x: Array,
    points: Array,
    areas: Array,
    radius: float,
    least: float,
    free: bool,
    single: float,
    double: float,
    by_x: Array,
    by_points: Array,
    by_areas: Array,
) -> None:
    """Add the derivatives of ``single`` and ``double`` times ``kernels.panel_integrals``.

    To ``by_x`` (3,), ``by_points`` (Q, 3) and ``by_areas`` (Q, 3), in place.
    """
    x0, x1, x2 = x[0], x[1], x[2]
    xx = x0 * x0 + x1 * x1 + x2 * x2
    s0, s1, s2 = 0.0, 0.0, 0.0
    for k in range(points.shape[0]):
        y0, y1, y2 = points[k, 0], points[k, 1], points[k, 2]
        n0, n1, n2 = areas[k, 0], areas[k, 1], areas[k, 2]
        area = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2 + least)
        disc = math.sqrt(area / math.pi)
        nx, ny = n0 * x0 + n1 * x1 + n2 * x2, n0 * y0 + n1 * y1 + n2 * y2
        d0, d1, d2 = x0 - y0, x1 - y1, x2 - y2
        by_rr, by_xx, by_xy, by_yy = 0.0, 0.0, 0.0, 0.0
        by_nx, by_ny, by_disc, by_area = 0.0, 0.0, 0.0, 0.0
        if free:
            r, by_squared, through = rounded_slopes(d0 * d0 + d1 * d1 + d2 * d2, disc)
            inverse = 1.0 / r
            cube = double * inverse * inverse * inverse
            by_r = -inverse * (single * area * inverse + 3.0 * cube * (nx - ny))
            by_rr, by_disc = by_r * by_squared, by_r * through
            by_nx, by_ny, by_area = cube, -cube, single * inverse
        if radius > 0.0:
            xy, yy = x0 * y0 + x1 * y1 + x2 * y2, y0 * y0 + y1 * y1 + y2 * y2
            by_xx, by_xy, by_yy, more_nx, more_ny, more_disc, value = image_slopes(
                xx, xy, yy, nx, ny, disc, radius, single * area, double
            )
            by_nx, by_ny, by_disc = by_nx + more_nx, by_ny + more_ny, by_disc + more_disc
            by_area += single * value
        apart, own, other = 2.0 * by_rr, 2.0 * by_xx, 2.0 * by_yy
        s0 += apart * d0 + own * x0 + by_xy * y0 + by_nx * n0
        s1 += apart * d1 + own * x1 + by_xy * y1 + by_nx * n1
        s2 += apart * d2 + own * x2 + by_xy * y2 + by_nx * n2
        by_points[k, 0] += other * y0 - apart * d0 + by_xy * x0 + by_ny * n0
        by_points[k, 1] += other * y1 - apart * d1 + by_xy * x1 + by_ny * n1
        by_points[k, 2] += other * y2 - apart * d2 + by_xy * x2 + by_ny * n2
        size = (by_area + 0.5 * by_disc * disc / area) / area
        by_areas[k, 0] += size * n0 + by_nx * x0 + by_ny * y0
        by_areas[k, 1] += size * n1 + by_nx * x1 + by_ny * y1
        by_areas[k, 2] += size * n2 + by_nx * x2 + by_ny * y2
    by_x[0] += s0
    by_x[1] += s1
    by_x[2] += s2


@compiled
def influence_slopes(
    centres: Array,
    coarse: Array,
    coarse_areas: Array,
    fine: Array,
    fine_areas: Array,
    touching: AnyArray,
    radius: float,
    least: float,
    by_single: Array,
    by_double: Array,
    by_centres: Array,
    by_coarse: Array,
    by_coarse_areas: Array,
    by_fine: Array,
    by_fine_areas: Array,
) -> None:
    """Add dE to the last five, shaped as the first five.

    ``by_single`` (F, F) are s over the area of j, ``by_double`` (F, F) are d. Left out: the panels'
    own free potential, and the areas that S is divided by.
    """
    count = centres.shape[0]
    for i in range(count):
        for j in range(count):
            single = PER_SPHERE * by_single[i, j]
            double = PER_SPHERE * (by_double[i, j] - by_double[i, i])  # the rows' sum is kept
            if touching[i, j]:
                panel_slopes(
                    centres[i], fine[j], fine_areas[j], radius, least, i != j, single, double,
                    by_centres[i], by_fine[j], by_fine_areas[j],
                )  # fmt: skip
            else:
                panel_slopes(
                    centres[i], coarse[j], coarse_areas[j], radius, least, True, single, double,
                    by_centres[i], by_coarse[j], by_coarse_areas[j],
                )  # fmt: skip
