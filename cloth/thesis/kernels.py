"""The compiled twins of ``cloth.thesis.reference``: same names, same arguments, same answers."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.compiled import compiled
from cloth.thesis.constants import COLUMNS, OFFSETS, ROWS, STRETCHING, Constants
from cloth.thesis.reference import BENDING_SWEEPS, SWEEPS_MAX, TOUCHING


@compiled
def _cross(a: Array, b: Array, product: Array) -> float:
    """a x b into ``product`` (3,); returns its length."""
    product[0] = a[1] * b[2] - a[2] * b[1]
    product[1] = a[2] * b[0] - a[0] * b[2]
    product[2] = a[0] * b[1] - a[1] * b[0]
    return math.sqrt(product[0] ** 2 + product[1] ** 2 + product[2] ** 2)


@compiled
def node_areas(x: Array) -> Array:
    """See ``cloth.thesis.grid.node_areas``."""
    n, m = x.shape[0], x.shape[1]
    areas = np.zeros((n, m))
    a, b, c, unused = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for i in range(n - 1):
        for j in range(m - 1):
            for d in range(3):
                a[d] = x[i, j + 1, d] - x[i, j, d]
                b[d] = x[i + 1, j, d] - x[i, j, d]
                c[d] = x[i + 1, j + 1, d] - x[i, j, d]
            cell = (_cross(a, c, unused) + _cross(b, c, unused)) / 8.0
            areas[i, j] += cell
            areas[i + 1, j] += cell
            areas[i, j + 1] += cell
            areas[i + 1, j + 1] += cell
    for i in range(n):
        areas[i, 0] = areas[i, m - 1] = 0.0
    for j in range(m):
        areas[0, j] = areas[n - 1, j] = 0.0
    return areas


@compiled
def unit_normals(x: Array) -> Array:
    """See ``cloth.thesis.reference.unit_normals``."""
    normals = np.zeros_like(x)
    along, across = np.empty(3), np.empty(3)
    for i in range(1, x.shape[0] - 1):
        for j in range(1, x.shape[1] - 1):
            for d in range(3):
                along[d] = x[i, j + 1, d] - x[i, j - 1, d]
                across[d] = x[i + 1, j, d] - x[i - 1, j, d]
            length = _cross(along, across, normals[i, j])
            for d in range(3):
                normals[i, j, d] /= length
    return normals


@compiled
def add_bending(
    x: Array, normals: Array, rest: Array, stiffness: float, di: int, dj: int, force: Array
) -> None:
    """See ``cloth.thesis.reference.add_bending``."""
    h, g = di // 2, dj // 2
    for i in range(h, x.shape[0] - h):
        for j in range(g, x.shape[1] - g):
            square, side = 0.0, 0.0
            for d in range(3):
                first, second = x[i - h, j - g, d], x[i + h, j + g, d]
                square += (second - first) ** 2
                side += (x[i, j, d] - 0.5 * (first + second)) * normals[i, j, d]
            relaxed = rest[i - h, j - g] ** 2
            deflection = 0.5 * math.sqrt(max(relaxed - square, 0.0))
            pull = -np.sign(side) * deflection * 48.0 * stiffness / relaxed
            for d in range(3):
                force[i, j, d] += pull * normals[i, j, d]


@compiled
def relieve(x: Array, rest: Array, back: Array, forth: Array, di: int, dj: int) -> float:
    """See ``cloth.thesis.reference.relieve``."""
    move = np.zeros_like(x)
    total = 0.0
    for i in range(max(0, -di), x.shape[0] - max(0, di)):
        for j in range(x.shape[1] - dj):
            p, q = i + di, j + dj
            a = x[p, q, 0] - x[i, j, 0]
            b = x[p, q, 1] - x[i, j, 1]
            c = x[p, q, 2] - x[i, j, 2]
            length = math.sqrt(a * a + b * b + c * c)
            error = length - rest[i, j]
            total += abs(error)
            own, other = error / length * back[i, j], error / length * forth[i, j]
            move[i, j, 0] += own * a
            move[i, j, 1] += own * b
            move[i, j, 2] += own * c
            move[p, q, 0] -= other * a
            move[p, q, 1] -= other * b
            move[p, q, 2] -= other * c
    for i in range(x.shape[0]):
        for j in range(x.shape[1]):
            for d in range(3):
                x[i, j, d] += move[i, j, d]
    return total


@compiled
def put_inside(x: Array, radius: float) -> None:
    """See ``cloth.thesis.reference.put_inside``."""
    for i in range(1, x.shape[0] - 1):
        for j in range(1, x.shape[1] - 1):
            square = x[i, j, 0] ** 2 + x[i, j, 1] ** 2 + x[i, j, 2] ** 2
            if square > (TOUCHING * radius) ** 2:
                for d in range(3):
                    x[i, j, d] *= radius / math.sqrt(square)


@compiled
def project(x: Array, c: Constants) -> tuple[float, int]:
    """See ``cloth.thesis.reference.project``."""
    error = 0.0
    for sweep in range(1, SWEEPS_MAX + 1):
        error = 0.0
        for k in range(STRETCHING):
            di, dj = OFFSETS[k]
            error += relieve(x, c.rest[k], c.back[k], c.forth[k], di, dj)
        if not error > c.allowed:
            return error, sweep
    return error, -1


@compiled
def move_freely(
    x: Array, v: Array, c: Constants, density: float, datum: float, body: Array, force: Array,
    dt: float,
) -> None:  # fmt: skip
    """See ``cloth.thesis.reference.move_freely``."""
    areas, normals, total = node_areas(x), unit_normals(x), force.copy()
    for k, swapped in ((COLUMNS, ROWS), (ROWS, COLUMNS)):
        di, dj = OFFSETS[swapped]
        add_bending(x, normals, c.rest[k], c.stiffness, di, dj, total)
    for i in range(1, x.shape[0] - 1):
        for j in range(1, x.shape[1] - 1):
            pressure = datum
            for d in range(3):
                pressure += density * x[i, j, d] * body[d]
            pressure *= areas[i, j]
            for d in range(3):
                total[i, j, d] += pressure * normals[i, j, d] + c.mass[i, j] * body[d]
                total[i, j, d] -= c.damping[i, j] * v[i, j, d]
                v[i, j, d] += dt * c.inverse_mass[i, j] * total[i, j, d]
                x[i, j, d] += dt * v[i, j, d]


@compiled
def advance(
    x: Array, v: Array, c: Constants, density: float, datum: Array, body: Array, force: Array,
    dt: float, steps: int,
) -> tuple[float, int]:  # fmt: skip
    """See ``cloth.thesis.reference.advance``."""
    error, total = 0.0, 0
    now = np.empty(3)
    for step in range(1, steps + 1):
        s = step / steps
        for d in range(3):
            now[d] = (1.0 - s) * body[0, d] + s * body[1, d]
        move_freely(x, v, c, density, (1.0 - s) * datum[0] + s * datum[1], now, force, dt)
        put_inside(x, c.radius)
        error, sweeps = project(x, c)
        if sweeps < 0:
            return error, -1
        for _ in range(BENDING_SWEEPS):
            for k in range(STRETCHING, len(OFFSETS)):
                di, dj = OFFSETS[k]
                relieve(x, c.rest[k], c.back[k], c.forth[k], di, dj)
        error, again = project(x, c)
        if again < 0:
            return error, -1
        total += sweeps + again
        put_inside(x, c.radius)
    return error, total
