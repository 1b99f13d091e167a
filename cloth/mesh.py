"""Triangle meshes of the moulded diaphragm, and what is measured on them once."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Bools, Ints
from cloth.mould import Hemisphere, Mould


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """A triangulated sheet in its moulded shape.

    ``points`` (n, 3) [m]; ``triangles`` (m, 3), counter-clockwise seen from the gas; ``fixed``
    (n,) clamped nodes; ``rim_distance`` (n,) [m] along the moulded shape to the rim.
    Neither manifoldness nor orientation is checked.
    """

    points: Array
    triangles: Ints
    fixed: Bools
    rim_distance: Array


def _strip(inner: Array, outer: Array, i0: int, o0: int) -> list[tuple[int, int, int]]:
    """Triangles between two rings given by their angles [rad], first nodes ``i0`` and ``o0``.

    Walks both rings once round and always advances where the new edge turns less, so that every
    edge of either ring is used once whatever the two counts are.
    """
    n, m = len(inner), len(outer)
    turn = 2.0 * np.pi
    a, b = 0, 0
    triangles: list[tuple[int, int, int]] = []
    while a < n or b < m:
        next_a = inner[(a + 1) % n] + turn * ((a + 1) // n)
        next_b = outer[(b + 1) % m] + turn * ((b + 1) // m)
        here_a = inner[a % n] + turn * (a // n)
        here_b = outer[b % m] + turn * (b // m)
        advance_outer = a >= n or (b < m and abs(next_b - here_a) <= abs(next_a - here_b))
        if advance_outer:
            triangles.append((i0 + a % n, o0 + b % m, o0 + (b + 1) % m))
            b += 1
        else:
            triangles.append((i0 + a % n, o0 + b % m, i0 + (a + 1) % n))
            a += 1
    return triangles


def hemisphere(radius: float, rings: int, *, density: float = 1.0) -> Mesh:
    """Return a mesh of the hemisphere z >= 0 of ``radius`` [m], made by ``moulded``.

    ``density`` 1 makes the triangles near equilateral (edges within a factor 1.54): 746 nodes at
    18 rings, 1316 at 24. A lower one stretches them along the rings (0.54: 713 nodes at 24, factor
    2.4).
    """
    return moulded(Hemisphere(radius), rings, density=density)


def moulded(mould: Mould, rings: int, *, density: float = 1.0) -> Mesh:
    """Return a mesh of the ``mould``, its rim exactly on z = 0.

    A node at the pole and ``rings`` rings at equal steps ds of the meridian's arc length, ring k
    with round(density 2 pi r_k cos(30 deg) / ds) nodes (at least six), every second ring turned by
    half a spacing.
    """
    if rings < 2:
        raise ValueError(f"cloth.resolution: needs at least 2 rings, got {rings}.")
    step = mould.length / rings
    points = [np.array([[0.0, 0.0, mould.ring(0, rings)[1]]])]
    distances = [np.array([mould.length])]
    angles: list[Array] = []
    triangles: list[tuple[int, int, int]] = []
    start = 1
    for k in range(1, rings + 1):
        r, z = mould.ring(k, rings)
        around = density * 2.0 * np.pi * r * np.cos(np.pi / 6.0) / step
        count = max(6, round(float(around)))
        angle = 2.0 * np.pi * (np.arange(count) + 0.5 * (k % 2)) / count
        ring = np.column_stack([r * np.cos(angle), r * np.sin(angle), np.full(count, z)])
        if k == 1:
            triangles += [(0, 1 + i, 1 + (i + 1) % count) for i in range(count)]
        else:
            triangles += _strip(angles[-1], angle, start - len(angles[-1]), start)
        points.append(ring)
        distances.append(np.full(count, step * (rings - k)))
        angles.append(angle)
        start += count
    positions = np.concatenate(points)
    fixed = np.arange(start) >= start - len(angles[-1])
    return Mesh(
        points=positions,
        triangles=np.array(triangles, dtype=np.int64),
        fixed=fixed,
        rim_distance=np.concatenate(distances),
    )


def rest_gradients(points: Array, triangles: Ints) -> tuple[Array, Array]:
    """Return the gradients of the triangles' hat functions in the moulded shape, and their areas.

    With g the gradients, F = sum_i x_i g_i^T (3 x 2) maps a triangle's moulded plane to space; its
    singular values are the principal stretches.

    Parameters
    ----------
    points
        Moulded positions (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3); that none has zero area is not checked.

    Returns
    -------
    gradients : Array
        One row a corner (m, 3, 2) [1/m], in axes of each triangle's plane, the first along its
        first edge.
    areas : Array
        Areas (m,) [m^2].
    """
    e1 = points[triangles[:, 1]] - points[triangles[:, 0]]
    e2 = points[triangles[:, 2]] - points[triangles[:, 0]]
    length = np.linalg.norm(e1, axis=1)
    along = np.einsum("ij,ij->i", e1, e2) / length
    across = np.linalg.norm(np.cross(e1, e2), axis=1) / length
    g1 = np.stack([1.0 / length, -along / (length * across)], axis=1)
    g2 = np.stack([np.zeros_like(length), 1.0 / across], axis=1)
    return np.stack([-g1 - g2, g1, g2], axis=1), 0.5 * length * across


def lumped(mesh: Mesh, per_area: Array | float = 1.0) -> Array:
    """Return an area density lumped to the nodes (n,): a third of every adjoining triangle's share.

    A triangle's share is its moulded area [m^2] times ``per_area`` (m,), in any unit per area.
    """
    _, areas = rest_gradients(mesh.points, mesh.triangles)
    result = np.zeros(len(mesh.points))
    np.add.at(result, mesh.triangles.ravel(), np.repeat(areas * per_area / 3.0, 3))
    return result


def corners_of(triangles: Ints, size: int) -> tuple[Ints, Ints]:
    """Return the triangles' corners sorted by node: where each node's begin, and the corners.

    Those of node i of ``size`` are the rows ``starts[i]`` to ``starts[i + 1]`` of (3 m, 2), with
    ``starts`` (size + 1,). A row is a triangle and which of its corners, 0 to 2.
    """
    nodes = triangles.ravel()
    order = np.argsort(nodes, kind="stable")
    starts = np.searchsorted(nodes[order], np.arange(size + 1))
    return starts, np.stack([order // 3, order % 3], axis=1)


def border_nodes(triangles: Ints) -> Ints:
    """Return the nodes on edges of one triangle only, sorted; none where the sheet is closed."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    pairs, count = np.unique(edges, axis=0, return_counts=True)
    return np.unique(pairs[count == 1])
