"""From a half ball to a coarser one of the same blocks: where its points are, what its faces sweep.

Meshes of the family sample one map of the blocks (``blocks``), so that a point or a cell of one has
its place among those of another by its levels alone, wherever the points have moved.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array, kron

from coupling.finite_volume.blocks import half_blocks
from coupling.finite_volume.mesh import LiquidMesh, divided
from coupling.finite_volume.mesh_sizes import coarsest_for
from coupling.ports import Array, Ints


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

    See ``coarsest_for``; None where ``mesh`` itself is no finer.
    """
    if mesh.divisions is None:
        return None
    coarse = divided(coarsest_for(nodes, mesh.divisions))
    if mesh.cells <= coarse.cells or not _is_finer(mesh, coarse):
        return None
    return coarsening(mesh, coarse)


def coarsening(fine: LiquidMesh, coarse: LiquidMesh) -> Coarsening:
    """Return the half ball ``coarse`` as a coarsening of the half ball ``fine``.

    Raises ``ValueError`` where they are no half balls, or ``fine`` is coarser in some direction.
    """
    if not _is_finer(fine, coarse):
        raise ValueError(f"no coarsening of a mesh of {fine.cells} cells to one of {coarse.cells}")
    assert coarse.divisions is not None
    assert fine.divisions is not None
    below, above = half_blocks(coarse.divisions).blocks, half_blocks(fine.divisions).blocks
    points = _joined(
        (own.points, its.points, _lines(own.levels, its.levels))
        for own, its in zip(below, above, strict=True)
    )
    faces = _joined(
        (top, finer, [_overlap(*edges) for edges in zip(own, its, strict=True)])
        for (top, own), (finer, its) in zip(_tops(coarse), _tops(fine), strict=True)
    )
    return Coarsening(mesh=coarse, points=points, faces=faces)


def _is_finer(fine: LiquidMesh, coarse: LiquidMesh) -> bool:
    """Whether both are half balls, ``fine`` of no fewer cells in any direction."""
    own, its = fine.divisions, coarse.divisions
    return own is not None and its is not None and own.holds(its)


def _lines(coarse: Sequence[Array], fine: Sequence[Array]) -> list[csr_array]:
    """Interpolation along each direction of a block."""
    return [_interpolation(*levels) for levels in zip(coarse, fine, strict=True)]


def _tops(mesh: LiquidMesh) -> list[tuple[Ints, tuple[Array, ...]]]:
    """Faces of the diaphragm (i, j, k) in each of the blocks that have some, and their edges.

    They are one cell thick, of one interval.
    """
    assert mesh.divisions is not None
    face = np.full(mesh.cells, -1)
    face[mesh.owner[mesh.diaphragm]] = np.arange(mesh.diaphragm_faces)
    found = []
    for block in half_blocks(mesh.divisions).blocks:
        grid = face[block.cells]
        if (grid < 0).all():
            continue
        places = [np.unique(place) for place in np.argwhere(grid >= 0).T]
        edges = tuple(
            levels if len(at) > 1 else np.array([0.0, 1.0])
            for at, levels in zip(places, block.levels, strict=True)
        )
        found.append((grid[np.ix_(*places)], edges))
    return found


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
    divisions = mesh.divisions
    while divisions is not None and len(within) > least and len(divisions.side) > 3:
        coarser = divided(divisions.halved())
        assert coarser.divisions is not None
        pairs = zip(
            half_blocks(divisions).blocks, half_blocks(coarser.divisions).blocks, strict=True
        )
        inside = np.setdiff1d(np.arange(len(coarser.points)), coarser.faces[coarser.inner_faces :])
        line = _joined(
            (own.points, its.points, _lines(own.levels, its.levels)) for own, its in pairs
        )
        found.append(csr_array(line[within][:, inside]))
        divisions, within = coarser.divisions, inside
    return found


def _joined(blocks: Iterable[tuple[Ints, Ints, Sequence[csr_array]]]) -> csr_array:
    """Matrix between what stands at places of two meshes' blocks, -1 for nothing.

    By block: its places in both, and the matrix along each of its directions. What stands in
    several blocks has the same row in each.
    """
    rows, columns, values = [], [], []
    count, known = np.zeros(2, int), np.zeros(0, int)
    for coarse, fine, lines in blocks:
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


def _interpolation(coarse: Array, fine: Array) -> csr_array:
    """Weights (k', k) at levels ``coarse`` (k',) of values at levels ``fine`` (k,)."""
    lower = np.clip(np.searchsorted(fine, coarse, side="right") - 1, 0, len(fine) - 2)
    share = (coarse - fine[lower]) / (fine[lower + 1] - fine[lower])
    share[np.abs(share) < 1e-12] = 0.0  # a point on both has one weight, exactly 1
    share[np.abs(share - 1.0) < 1e-12] = 1.0
    rows = np.arange(len(coarse))
    entries = np.r_[1.0 - share, share], (np.r_[rows, rows], np.r_[lower, lower + 1])
    return csr_array(coo_array(entries, shape=(len(coarse), len(fine))))


def _overlap(coarse: Array, fine: Array) -> csr_array:
    """Shares (k', k) of the intervals between edges ``fine`` (k + 1,) in those of ``coarse``.

    What the finer intervals hold is taken to vary linearly along each, as from the one before it
    to the one behind it: spread evenly, short waves would fade.
    """
    width, centre = np.diff(fine), 0.5 * (fine[1:] + fine[:-1])
    start, end = (
        np.clip(edge[:, None] - centre, -0.5 * width, 0.5 * width)
        for edge in (coarse[:-1], coarse[1:])
    )
    shares = (end - start) / width
    if len(width) > 1:
        at = np.arange(len(width))
        before, behind = np.maximum(at - 1, 0), np.minimum(at + 1, len(width) - 1)
        slope = np.zeros((len(width), len(width)))
        slope[at, behind] = 1.0 / width[behind] / (centre[behind] - centre[before])
        slope[at, before] -= 1.0 / width[before] / (centre[behind] - centre[before])
        shares += 0.5 * (end**2 - start**2) @ slope
    shares[np.abs(shares) < 1e-12] = 0.0  # rounding of edges that coincide
    return csr_array(shares)
