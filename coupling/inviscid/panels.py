"""Panels of a sheet: where their integrals are sampled, and which of them touch."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from coupling.interface import cross
from coupling.ports import Array, Ints

COARSE, FINE = 2, 4  # points along an edge: pairs of panels apart, and pairs that touch


@dataclass(frozen=True, kw_only=True)
class Rule:
    """Quadrature on one panel: ``shape``, ``along``, ``across`` (Q, k) times its corners (k, 3).

    They give the points, and the two tangents whose cross product is the area that a point stands
    for, its weight included.
    """

    shape: Array
    along: Array
    across: Array

    def sample(self, corner: Array) -> tuple[Array, Array]:
        """Points (F, Q, 3) [m] and their area vectors (F, Q, 3) [m^2] on panels (F, k, 3)."""
        return self.shape @ corner, cross(self.along @ corner, self.across @ corner)


@lru_cache
def rule(corners: int, count: int) -> Rule:
    """Tensor Gauss rule of ``count``^2 points on bilinear quadrilaterals, or so many on triangles.

    Triangles take the three-point rule of degree 2 on (count/2)^2 equal parts.
    """
    if corners == 4:
        node, weight = np.polynomial.legendre.leggauss(count)
        u, v = np.repeat((node + 1) / 2, count), np.tile((node + 1) / 2, count)
        size = np.sqrt(np.outer(weight, weight).ravel() / 4)[:, None]
        shape = np.stack([(1 - u) * (1 - v), u * (1 - v), u * v, (1 - u) * v], axis=1)
        along = np.stack([v - 1, 1 - v, v, -v], axis=1)
        across = np.stack([u - 1, -u, u, 1 - u], axis=1)
        return Rule(shape=shape, along=size * along, across=size * across)
    parts = count // 2
    inner = np.array([(4, 1, 1), (1, 4, 1), (1, 1, 4)]) / 6
    points = []
    for i in range(parts):
        for j in range(parts - i):
            here = np.array([(i, j), (i + 1, j), (i, j + 1)])
            points.append(inner @ here)
            if i + j + 2 <= parts:
                points.append(inner @ np.array([(i + 1, j + 1), (i, j + 1), (i + 1, j)]))
    second, third = (np.concatenate(points) / parts).T
    shape = np.stack([1 - second - third, second, third], axis=1)
    size = np.sqrt(0.5 / len(shape))
    ones = np.ones((len(shape), 1))
    return Rule(
        shape=shape,
        along=size * ones * np.array([(-1.0, 1.0, 0.0)]),
        across=size * ones * np.array([(-1.0, 0.0, 1.0)]),
    )


@dataclass(frozen=True, kw_only=True)
class Topology:
    """What stays while the points move: ``touching`` (F, F), ``edge`` (p,) points of the border."""

    touching: NDArray[np.bool_]
    edge: NDArray[np.bool_]


def topology(faces: Ints, count: int) -> Topology:
    """Topology of ``faces`` (F, k) over ``count`` points; remembered for the last few meshes."""
    faces = np.ascontiguousarray(faces, dtype=np.int64)
    return _topology(faces.tobytes(), faces.shape[1], count)


@lru_cache(maxsize=8)
def _topology(data: bytes, corners: int, count: int) -> Topology:
    faces = np.frombuffer(data, dtype=np.int64).reshape(-1, corners)
    has = np.zeros((len(faces), count), dtype=np.float32)
    has[np.arange(len(faces))[:, None], faces] = 1
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, group, number = np.unique(
        np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    edge = np.zeros(count, dtype=bool)
    edge[sides[number[group.ravel()] == 1]] = True
    touching = has @ has.T > 0.5
    for array in (touching, edge):
        array.flags.writeable = False
    return Topology(touching=touching, edge=edge)


def kept_off(points: Array, edge: NDArray[np.bool_], radius: float, clearance: float) -> Array:
    """``points`` (p, 3) [m] with a film of ``clearance`` R and more between them and the shell.

    A point at the distance d from the shell goes to d + (2 c - d)^2 / (4 c), c = clearance R, where
    d < 2 c: once differentiable, and nothing beyond. The border ``edge`` stays where it is.
    """
    if clearance <= 0:
        return points
    moved: Array = points * film_scale(points, edge, radius, clearance)[0][:, None]
    return moved


def film_scale(
    points: Array, edge: NDArray[np.bool_], radius: float, clearance: float
) -> tuple[Array, Array]:
    """Factor (p,) of ``kept_off`` on each point, and its derivative by the distance |x| (p,)."""
    distance = np.maximum(np.linalg.norm(points, axis=1), 1e-30)
    film = clearance * radius
    over = np.clip(distance - (radius - 2 * film), 0.0, 2 * film)
    beyond = np.maximum(distance - radius, 0.0)
    kept = distance - over**2 / (4 * film) - beyond
    slope = 1 - over / (2 * film)  # 0 on the shell and beyond
    factor, rate = kept / distance, slope / distance - kept / distance**2
    return np.where(edge, 1.0, factor), np.where(edge, 0.0, rate)
