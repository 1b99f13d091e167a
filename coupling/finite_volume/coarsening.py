"""From a half ball to a coarser one of the same blocks: where its points are, what its faces sweep.

Meshes of the family sample one map of the blocks (``blocks``), so that a point or a cell of one has
its place among those of another by counting alone, wherever the points have moved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, kron

from coupling.finite_volume.blocks import lower_blocks
from coupling.finite_volume.mesh import LiquidMesh, cells_of_faces, divisions, half_ball
from coupling.ports import Ints


@dataclass(frozen=True, kw_only=True)
class Coarsening:
    """A coarser ``mesh`` of the family, and its relations to the finer one.

    ``points`` (P', P): trilinear interpolation of the finer mesh's points, P' being those of
    ``mesh``; rows sum to 1. ``faces`` (F', F): share of every face of the finer diaphragm in those
    of ``mesh``, by the overlap in the blocks; columns sum to 1, so that volumes are kept.
    """

    mesh: LiquidMesh
    points: csr_array
    faces: csr_array


def coarser_for(mesh: LiquidMesh, nodes: int) -> Coarsening | None:
    """Return the coarsening of the half ball ``mesh`` for a structure of so many ``nodes``.

    None where its diaphragm has no more faces than the structure has nodes.
    """
    if mesh.diaphragm_faces <= nodes:
        return None
    return coarsening(mesh, cells_of_faces(nodes))


def coarsening(fine: LiquidMesh, cells: int) -> Coarsening:
    """Return the half ball of at most ``cells`` cells as a coarsening of the half ball ``fine``.

    Raises ``ValueError`` where ``fine`` is no half ball, or one of less cells.
    """
    mesh = half_ball(cells)
    below, above = (lower_blocks(*divisions(size)) for size in (mesh.cells, fine.cells))
    if len(above.hexes) != fine.cells or mesh.cells > fine.cells:
        raise ValueError(f"no coarsening of a mesh of {fine.cells} cells to one of {mesh.cells}")
    points = _joined(zip(below.grids, above.grids, strict=True), _interpolation)
    cells_within = _joined(zip(below.cells, above.cells, strict=True), _overlap)
    top, fine_top = mesh.owner[mesh.diaphragm], fine.owner[fine.diaphragm]
    return Coarsening(mesh=mesh, points=points, faces=csr_array(cells_within[top][:, fine_top]))


def _joined(
    blocks: Iterable[tuple[Ints, Ints]], along: Callable[[int, int], csr_array]
) -> csr_array:
    """Matrix between what stands at places of two meshes' blocks, -1 for nothing.

    ``along`` gives it for one direction of a block, of the sizes there. What stands in several
    blocks has the same row in each.
    """
    rows, columns, values = [], [], []
    count, known = np.zeros(2, int), np.zeros(0, int)
    for coarse, fine in blocks:
        lines = [along(*sizes) for sizes in zip(coarse.shape, fine.shape, strict=True)]
        block = coo_array(kron(kron(lines[0], lines[1]), lines[2]))
        row, column = coarse.ravel()[block.row], fine.ravel()[block.col]
        kept = (row >= 0) & (column >= 0) & (block.data != 0.0) & ~np.isin(row, known)
        rows.append(row[kept])
        columns.append(column[kept])
        values.append(block.data[kept])
        count = np.maximum(count, [coarse.max() + 1, fine.max() + 1])
        known = np.union1d(known, coarse)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return csr_array(coo_array(entries, shape=tuple(count)))


def _interpolation(coarse: int, fine: int) -> csr_array:
    """Weights (coarse, fine) of as many points, evenly from the same start to the same end."""
    at = np.arange(coarse) * (fine - 1)  # in integers: a point on both has one weight, exactly 1
    lower = np.minimum(at // (coarse - 1), fine - 2)
    share = at / (coarse - 1) - lower
    rows = np.arange(coarse)
    entries = np.r_[1.0 - share, share], (np.r_[rows, rows], np.r_[lower, lower + 1])
    return csr_array(coo_array(entries, shape=(coarse, fine)))


def _overlap(coarse: int, fine: int) -> csr_array:
    """Shares (coarse, fine) of intervals of the second division of a length in those of the first.

    Both divisions are even.
    """
    starts, ends = np.arange(fine) / fine, np.arange(1, fine + 1) / fine
    edges = np.arange(coarse + 1)[:, None] / coarse
    common = np.minimum(edges[1:], ends) - np.maximum(edges[:-1], starts)
    shares = np.maximum(common * fine, 0.0)
    shares[shares < 1e-9] = 0.0  # rounding of edges that coincide
    return csr_array(shares / shares.sum(axis=0))
