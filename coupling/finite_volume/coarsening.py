"""From a half ball to a coarser one of the same blocks: where its points are, what its faces sweep.

Meshes of the family sample one map of the blocks (``blocks``), so that a point or a cell of one has
its place among those of another by counting alone, wherever the points have moved.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, kron

from coupling.finite_volume.blocks import Blocks, lower_blocks
from coupling.finite_volume.mesh import LiquidMesh, cells_for_nodes, cells_of, divisions, half_ball
from coupling.ports import Ints


@dataclass(frozen=True, kw_only=True)
class Coarsening:
    """A coarser ``mesh`` of the family, and its relations to the finer one.

    ``points`` (P', P): trilinear interpolation of the finer mesh's points, P' being those of
    ``mesh``; rows sum to 1. ``faces`` (F', F): share of every face of the finer diaphragm in those
    of ``mesh``, by the overlap in the blocks to second order; columns sum to 1, so that volumes are
    kept.
    """

    mesh: LiquidMesh
    points: csr_array
    faces: csr_array


def coarser_for(mesh: LiquidMesh, nodes: int) -> Coarsening | None:
    """Return the coarsening of the half ball ``mesh`` that is as fine as a structure of ``nodes``.

    See ``cells_for_nodes``; None where ``mesh`` itself is no finer.
    """
    cells = cells_for_nodes(nodes)
    return None if mesh.cells <= cells else coarsening(mesh, cells)


def coarsening(fine: LiquidMesh, cells: int) -> Coarsening:
    """Return the half ball of at most ``cells`` cells as a coarsening of the half ball ``fine``.

    Raises ``ValueError`` where ``fine`` is no half ball, or one of less cells.
    """
    mesh = half_ball(cells)
    below, above = (lower_blocks(*divisions(size)) for size in (mesh.cells, fine.cells))
    if len(above.hexes) != fine.cells or mesh.cells > fine.cells:
        raise ValueError(f"no coarsening of a mesh of {fine.cells} cells to one of {mesh.cells}")
    points = _joined(zip(below.grids, above.grids, strict=True), _interpolation)
    faces = _joined(zip(_tops(mesh, below), _tops(fine, above), strict=True), _overlap)
    return Coarsening(mesh=mesh, points=points, faces=faces)


def _tops(mesh: LiquidMesh, blocks: Blocks) -> list[Ints]:
    """Faces of the diaphragm (i, j, k) in each of the blocks that have some, one cell thick."""
    face = np.full(mesh.cells + 1, -1)
    face[mesh.owner[mesh.diaphragm]] = np.arange(mesh.diaphragm_faces)
    grids = [face[cells] for cells in blocks.cells]
    places = [np.unique(np.argwhere(grid >= 0), axis=0) for grid in grids]
    return [
        grid[np.ix_(*(np.unique(place) for place in at.T))]
        for grid, at in zip(grids, places, strict=True)
        if len(at)
    ]


def prolongations(mesh: LiquidMesh, within: Ints, least: int) -> list[csr_array]:
    """Return the interpolations to a half ball from coarser ones, each of half the divisions.

    Parameters
    ----------
    mesh
        The half ball; of any other mesh there are none.
    within
        Its points inside (k,), sorted.
    least
        Points inside of the coarsest one, about: there is none below so many.

    Returns
    -------
    list of csr_array
        Trilinear interpolation (k, k') from the next coarser mesh's points inside, zero on the
        boundary, from the finest to the coarsest.
    """
    found: list[csr_array] = []
    if len(within) <= least:
        return found
    n, layers = divisions(mesh.cells)
    blocks = lower_blocks(n, layers)
    if not np.array_equal(blocks.points, mesh.points):
        return found
    while len(within) > least and n > 2:
        n = max(2, 2 * round(n / 4))
        coarser = half_ball(cells_of(n))
        below = lower_blocks(*divisions(coarser.cells))
        inside = np.setdiff1d(np.arange(len(below.points)), coarser.faces[coarser.inner_faces :])
        line = _joined(zip(blocks.grids, below.grids, strict=True), _interpolation)
        found.append(csr_array(line[within][:, inside]))
        blocks, within = below, inside
    return found


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

    Both divisions are even. What the finer intervals hold is taken to vary linearly along each, as
    from the one before it to the one behind it: spread evenly, short waves would fade.
    """
    edges = np.arange(coarse + 1)[:, None] * fine / coarse  # in finer intervals
    centre = np.arange(fine) + 0.5
    start, end = (np.clip(edge - centre, -0.5, 0.5) for edge in (edges[:-1], edges[1:]))
    slope = 0.5 * (np.eye(fine, k=1) - np.eye(fine, k=-1))
    slope[[0, -1]] *= 2.0
    slope[[0, -1], [0, -1]] = -1.0, 1.0
    shares = end - start + 0.5 * (end**2 - start**2) @ (slope if fine > 1 else np.zeros((1, 1)))
    shares[np.abs(shares) < 1e-12] = 0.0  # rounding of edges that coincide
    return csr_array(shares)
