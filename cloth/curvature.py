"""Curvature at the nodes of a mesh: constant matrices in its moulded metric.

For a sheet that does not stretch, the second derivatives of the position along the surface are
b n, with b the curvature and n the normal: their combinations are fixed rows of numbers, and what
is quadratic in b has a constant matrix (Bergou et al., "A quadratic bending model for inextensible
surfaces", 2006).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from cloth import kernels
from cloth.arrays import Array, Bools, Ints
from cloth.linear import stretch_matrix
from cloth.mesh import Mesh, border_nodes, rest_gradients


@dataclass(frozen=True, kw_only=True)
class Curvature:
    """Rows (n, n) [1/m^2] that take positions to components of b n, zero on the border.

    ``trace``: b11 + b22, by the cotangents' Laplacian over ``voronoi_areas``; ``difference``:
    b11 - b22 and ``twist``: 2 b12, of the parabola through a node that fits its neighbours best, in
    axes of its own. ``laplacian`` (n, n) [-]: the cotangents', of all nodes; on the border it gives
    minus the node's area times b11 + b22, and the border's length times the slope across it.
    ``normals`` (n, 3) of the moulded shape.
    """

    trace: sp.csr_matrix
    difference: sp.csr_matrix
    twist: sp.csr_matrix
    laplacian: sp.csr_matrix
    normals: Array


def curvature_of(mesh: Mesh) -> Curvature:
    """Return the rows that take positions to the curvature of ``mesh``.

    At the mesh's own points they give vectors along the normals. The parabola takes five neighbours
    to be determined, which every node off the border of the meshes in ``cloth`` has.
    """
    size = len(mesh.points)
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    inside = np.ones(size)
    inside[border_nodes(mesh.triangles)] = 0.0
    normal = np.zeros_like(mesh.points)
    everywhere = np.ones(size, dtype=bool)
    kernels.volume_and_gradient(mesh.points, mesh.triangles, everywhere, normal)
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    laplacian = stretch_matrix(mesh.triangles, gradients, areas, size).tocsr()
    trace = -sp.csr_matrix(sp.diags(inside / voronoi_areas(mesh)) @ laplacian)
    rows = (trace, *_parabolas(mesh, normal, inside > 0.0))
    trace, difference, twist = (_upright(row, mesh, normal) for row in rows)
    return Curvature(
        trace=trace, difference=difference, twist=twist, laplacian=laplacian, normals=normal
    )


def voronoi_areas(mesh: Mesh) -> Array:
    """Return each node's own area (n,) [m^2]: its triangles' nearest points, cut where obtuse.

    Meyer et al., "Discrete differential-geometry operators" (2003), section 3.3.
    """
    corner = mesh.points[mesh.triangles]
    _, areas = rest_gradients(mesh.points, mesh.triangles)
    own = np.zeros_like(corner[:, :, 0])
    angles = np.zeros_like(own)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        e, f = corner[:, j] - corner[:, i], corner[:, k] - corner[:, i]
        angles[:, i] = np.arctan2(2.0 * areas, np.einsum("td,td->t", e, f))
        opposite = np.einsum("td,td->t", corner[:, k] - corner[:, j], corner[:, k] - corner[:, j])
        share = opposite / np.tan(angles[:, i]) / 8.0
        own[:, j] += share
        own[:, k] += share
    obtuse = angles.max(axis=1) > 0.5 * np.pi
    blunt = angles > 0.5 * np.pi
    own[obtuse] = np.where(blunt[obtuse], 0.5, 0.25) * areas[obtuse, None]
    result = np.zeros(len(mesh.points))
    np.add.at(result, mesh.triangles, own)
    return result


def neighbours(triangles: Ints) -> Ints:
    """Return the pairs (p, 2) of nodes that share an edge, each in both orders, sorted."""
    edges = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    return np.unique(np.concatenate([edges, edges[:, ::-1]]), axis=0)


def _parabolas(mesh: Mesh, normal: Array, inside: Bools) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Rows (n, n) [1/m^2] of b11 - b22 and 2 b12 where ``inside`` (n,).

    Neighbours are laid into the tangent plane at their distance, and the five coefficients fitted
    by least squares.
    """
    pairs = neighbours(mesh.triangles)
    pairs = pairs[inside[pairs[:, 0]]]
    axis = np.eye(3)[np.argmin(np.abs(normal), axis=1)]
    first = np.cross(normal, axis)
    first /= np.linalg.norm(first, axis=1)[:, None]
    second = np.cross(normal, first)
    apart = mesh.points[pairs[:, 1]] - mesh.points[pairs[:, 0]]
    frame = np.stack([first, second], axis=1)[pairs[:, 0]]
    flat = np.einsum("pkd,pd->pk", frame, apart)
    flat *= (np.linalg.norm(apart, axis=1) / np.linalg.norm(flat, axis=1))[:, None]
    count = np.bincount(pairs[:, 0], minlength=len(mesh.points))
    start = np.cumsum(count) - count
    found = np.zeros((len(pairs), 2))
    for many in np.unique(count[count > 0]):
        span = start[count == many][:, None] + np.arange(many)
        u, v = flat[span, 0], flat[span, 1]
        size = np.sqrt(np.mean(u**2 + v**2, axis=1))[:, None]
        u, v = u / size, v / size
        fit = np.linalg.pinv(np.stack([u, v, 0.5 * u * u, 0.5 * v * v, u * v], axis=2))
        both = np.stack([fit[:, 2] - fit[:, 3], 2.0 * fit[:, 4]], axis=2)
        found[span] = both / size[:, :, None] ** 2
    shape = (len(mesh.points), len(mesh.points))
    rows = sp.csr_matrix((found[:, 0], (pairs[:, 0], pairs[:, 1])), shape=shape)
    more = sp.csr_matrix((found[:, 1], (pairs[:, 0], pairs[:, 1])), shape=shape)
    return _differences(rows), _differences(more)


def _differences(rows: sp.csr_matrix) -> sp.csr_matrix:
    """``rows`` that give nothing of a shift: each less its sum on the diagonal."""
    return sp.csr_matrix(rows - sp.diags(np.asarray(rows.sum(axis=1)).ravel()))


def _upright(rows: sp.csr_matrix, mesh: Mesh, normal: Array) -> sp.csr_matrix:
    """``rows`` less a multiple of each node's gradient, so that of X0 they are along ``normal``.

    Where neighbours are uneven, they lean over by O(h): the moulded shape would not be at rest.
    """
    corner = mesh.points[mesh.triangles]
    gradients, areas = rest_gradients(mesh.points, mesh.triangles)
    along = corner[:, 1] - corner[:, 0]
    along = along / np.linalg.norm(along, axis=1)[:, None]
    up = np.cross(along, corner[:, 2] - corner[:, 0])
    across = np.cross(up / np.linalg.norm(up, axis=1)[:, None], along)
    slopes = gradients[:, :, :1] * along[:, None] + gradients[:, :, 1:] * across[:, None]
    slopes = slopes * areas[:, None, None]  # (m, 3, 3): of each corner's hat function, in space
    size, corners = len(mesh.points), mesh.triangles
    nodes, others = np.repeat(corners, 3, axis=1).ravel(), np.tile(corners, (1, 3)).ravel()
    parts = [np.tile(slopes[:, :, d], (1, 3)).ravel() for d in range(3)]
    gradient = [sp.csr_matrix((part, (nodes, others)), shape=(size, size)) for part in parts]
    lean = rows @ mesh.points
    lean -= np.einsum("id,id->i", lean, normal)[:, None] * normal
    spread = np.stack([part @ mesh.points for part in gradient], axis=1)  # area * projector
    spread += np.einsum("id,ie->ide", normal, normal) * areas.mean()  # nothing leans that way
    share = np.linalg.solve(spread.transpose(0, 2, 1), lean[:, :, None])[:, :, 0]
    return sp.csr_matrix(rows - sum(sp.diags(share[:, d]) @ gradient[d] for d in range(3)))
