"""Bending about the moulded, curved shape: one quadratic energy per node.

The plate's energy is kappa/2 (2 H)^2 per area plus a multiple of the Gauss curvature, whose
integral the sheet's border fixes (Gauss and Bonnet). So only the mean curvature H is resisted: by
the Laplacian of the position, as Bergou et al., "A quadratic bending model for inextensible
surfaces" (2006), have it, here summed over each node's own area, which is exact for cylinders and
spheres alike. The moulded state enters through a signed normal, so that the mirrored shape costs
energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from cloth import kernels
from cloth.arrays import Array, Ints
from cloth.linear import stretch_matrix
from cloth.mesh import Mesh, border_nodes, rest_gradients


@dataclass(frozen=True, kw_only=True)
class Bending:
    """E = 1/2 sum_i kappa_i / A_i |(K x)_i - curvature_i normal_i|^2 over nodes off the border.

    ``matrix`` (n, n) [N/m]: Q = K^T diag(kappa/A) K, the constant Hessian for x, y and z alike.
    K [-], the Laplacian by cotangents, stands in rows: ``starts`` (n + 1,), ``columns`` and
    ``values``. ``moment`` (n,) [N]: kappa/A curvature, with ``curvature`` [m] = 2 H A as moulded.
    """

    matrix: sp.csc_matrix
    starts: Ints
    columns: Ints
    values: Array
    moment: Array


def voronoi_areas(mesh: Mesh) -> Array:
    """Each node's own area (n,) [m^2]: nearest points of its triangles, cut where obtuse.

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


def bending_of(mesh: Mesh, stiffness: Array) -> Bending:
    """Bending of ``mesh`` with kappa = ``stiffness`` (n,) [N m] at its nodes, at rest as moulded.

    The border is free to turn (simply supported where clamped). Where it is free to move too,
    saddles cost nothing: the border's own terms are left out.
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
    rows = sp.csr_matrix(sp.diags(inside) @ _upright(laplacian, mesh, normal))
    rows.eliminate_zeros()
    weight = inside * stiffness / voronoi_areas(mesh)
    curvature = np.einsum("id,id->i", rows @ mesh.points, normal)
    return Bending(
        matrix=sp.csc_matrix(rows.T @ sp.diags(weight) @ rows),
        starts=rows.indptr.astype(np.int64),
        columns=rows.indices.astype(np.int64),
        values=np.ascontiguousarray(rows.data),
        moment=weight * curvature,
    )


def _upright(laplacian: sp.csr_matrix, mesh: Mesh, normal: Array) -> sp.csr_matrix:
    """``laplacian`` less a multiple of each node's gradient, so that K X0 is along ``normal``.

    Where neighbours are uneven, K X0 leans over by O(h): the moulded shape would not be at rest.
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
    lean = laplacian @ mesh.points
    lean -= np.einsum("id,id->i", lean, normal)[:, None] * normal
    spread = np.stack([part @ mesh.points for part in gradient], axis=1)  # area * projector
    spread += np.einsum("id,ie->ide", normal, normal) * areas.mean()  # nothing leans that way
    share = np.linalg.solve(spread.transpose(0, 2, 1), lean[:, :, None])[:, :, 0]
    return sp.csr_matrix(laplacian - sum(sp.diags(share[:, d]) @ gradient[d] for d in range(3)))
