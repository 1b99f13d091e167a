"""OpenFOAM's ``Gauss linear corrected`` Laplacian (over-relaxed) of the cells, as a sparse matrix.

A cell's gradient takes its own value and its neighbours'; a face's flux those of both its cells. So
all matrices of a mesh have the same entries, whose places are found once. Beside a wall the
gradient takes the wall's own pressure, of which the part that the wall's acceleration makes stands
on the right-hand side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from cloth.compiled import compiled
from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.gradients import SLOTS, stencils, stencils_of, wall_distance
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array, Ints

SYMMETRIC: dict[str, Any] = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}


@dataclass(frozen=True, kw_only=True)
class Eliminated:
    """Order in which the cells are eliminated, and the entries of their matrix in that order.

    ``order`` (k,): all cells but one, which is held, the diaphragm's ``wall`` last. ``starts`` and
    ``rows``: the columns. ``places`` (inner, 2, SLOTS, 2): of each value in a face's flux, by the
    cell whose gradient it is in, in the rows of owner and neighbour; the last place is the held
    cell's.
    """

    order: Ints
    wall: Ints
    starts: NDArray[np.int32]
    rows: NDArray[np.int32]
    places: Ints

    def matrix(self, mesh: LiquidMesh, geometry: CellGeometry, gradient: Array) -> csc_array:
        """Return the outward flux of -grad p (k, k) [m] of every cell as a matrix, in ``order``.

        ``gradient`` (c, SLOTS, 3) [1/m]: ``Gradients.cells``.
        """
        values = np.zeros(len(self.rows) + 1)
        _fill(
            mesh.owner, mesh.neighbour, geometry.centre, geometry.face_centre, geometry.face_area,
            stencils(mesh).slots, self.places, gradient, values,
        )  # fmt: skip
        return csc_array((values[:-1], self.rows, self.starts), shape=(len(self.order),) * 2)


def eliminated(mesh: LiquidMesh) -> Eliminated:
    """The order and the entries for ``mesh``; found once for each topology."""
    return _eliminated(mesh.owner.tobytes(), mesh.neighbour.tobytes(), mesh.diaphragm.stop)


@lru_cache(maxsize=4)
def _eliminated(owner: bytes, neighbour: bytes, stop: int) -> Eliminated:
    """``owner``, ``neighbour``: the mesh's, as bytes; ``stop``: where the wall's faces end."""
    owners, neighbours = np.frombuffer(owner, np.int64), np.frombuffer(neighbour, np.int64)
    wall, cells = np.unique(owners[len(neighbours) : stop]), int(owners.max()) + 1
    columns = stencils_of(owner, neighbour, cells).columns
    own = np.repeat(np.arange(cells), SLOTS)
    near = csc_array(coo_array((np.ones(own.shape), (own, columns.ravel())), shape=(cells, cells)))
    near = csc_array(near @ near)
    order = _ordered(near, wall)
    pattern = csc_array(near[order][:, order])
    pattern.sort_indices()
    place = np.full(cells, -1)
    place[order] = np.arange(len(order))
    column_of = np.repeat(np.arange(len(order)), np.diff(pattern.indptr))
    known = column_of * len(order) + pattern.indices  # rising
    sides = np.stack([owners[: len(neighbours)], neighbours], axis=1)
    column, row = place[columns[sides]][..., None], place[sides][:, None, None, :]
    places = np.searchsorted(known, column * len(order) + row)
    places[np.broadcast_to((column < 0) | (row < 0), places.shape)] = len(known)
    return Eliminated(
        order=order, wall=wall, starts=pattern.indptr, rows=pattern.indices, places=places,
    )  # fmt: skip


def _ordered(near: csc_array, wall: Ints) -> Ints:
    """Cells but the first inner one, ordered for little fill with the ``wall``'s last.

    ``near`` (c, c): which cells meet in the matrix.
    """
    inner = np.setdiff1d(np.arange(near.shape[0]), wall)[1:]
    pattern = csc_array(near[inner][:, inner])
    pattern.setdiag(2.0 * pattern.sum(axis=0))
    found = splu(csc_array(pattern), permc_spec="MMD_AT_PLUS_A", **SYMMETRIC)
    return np.concatenate([inner[np.argsort(found.perm_c)], wall])


def wall_source(mesh: LiquidMesh, geometry: CellGeometry) -> csc_array:
    """Right-hand side (c, F) [-] that the flux of each face on the diaphragm makes, changing by 1.

    The flux itself, and what the wall's pressure, -d/A beyond its cell's over the half cell d, adds
    to the non-orthogonal fluxes about the cell through the cell's gradient.
    """
    wall, area = mesh.owner[mesh.diaphragm], geometry.face_area[mesh.diaphragm]
    reach = wall_distance(mesh, geometry) / np.linalg.norm(area, axis=1)
    slope = -area * (reach / geometry.volume[wall])[:, None]
    rows, columns, values = [wall], [np.arange(len(wall))], [-np.ones(len(wall))]
    for at, cell, other, face in _about(mesh):
        size = geometry.face_area[at]
        step = geometry.centre[mesh.neighbour[at]] - geometry.centre[mesh.owner[at]]
        slant = size - _stiffness(mesh, geometry, at)[:, None] * step
        near, far = (
            np.abs(_dot(geometry.face_centre[at] - geometry.centre[side], size))
            for side in (cell, other)
        )
        flux = far / (near + far) * _dot(slant, slope[face])
        for side, sign in ((mesh.owner[at], 1.0), (mesh.neighbour[at], -1.0)):
            rows.append(side)
            columns.append(face)
            values.append(sign * flux)
    entries = np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))
    return csc_array(coo_array(entries, shape=(mesh.cells, len(wall))))


def wall_layer(mesh: LiquidMesh, geometry: CellGeometry) -> tuple[csc_array, Array]:
    """Two-point flux [m] between the diaphragm's cells (F, F), and from each to those below (F,).

    ``-grad p`` flows out of a cell by the first's rows times p, and by the second times what p is
    higher there than below.
    """
    count = mesh.diaphragm_faces
    faces = np.full(mesh.cells, -1)
    faces[mesh.owner[mesh.diaphragm]] = np.arange(count)
    below, entries = np.zeros(count), []
    for at, _, other, face in _about(mesh):
        stiff, beside = _stiffness(mesh, geometry, at), faces[other]
        within = beside >= 0
        below += np.bincount(face[~within], stiff[~within], count)
        entries.append((face[within], face[within], stiff[within]))
        entries.append((face[within], beside[within], -stiff[within]))
    row, column, value = (np.concatenate(part) for part in zip(*entries, strict=True))
    return csc_array(coo_array((value, (row, column)), shape=(count, count))), below


def _about(mesh: LiquidMesh) -> list[tuple[Ints, Ints, Ints, Ints]]:
    """Inner faces of the diaphragm's cells: the faces, the cells, those beyond, their faces there.

    From the owners' side and from the neighbours'. One cell has one face on the diaphragm.
    """
    faces = np.full(mesh.cells, -1)
    faces[mesh.owner[mesh.diaphragm]] = np.arange(mesh.diaphragm_faces)
    owner, found = mesh.owner[: mesh.inner_faces], []
    for cell, other in ((owner, mesh.neighbour), (mesh.neighbour, owner)):
        at = np.flatnonzero(faces[cell] >= 0)
        found.append((at, cell[at], other[at], faces[cell[at]]))
    return found


def _stiffness(mesh: LiquidMesh, geometry: CellGeometry, at: Ints) -> Array:
    """Two-point flux (k,) [m] through inner faces ``at`` (k,) of a unit difference in p."""
    size = np.linalg.norm(geometry.face_area[at], axis=1)
    step = geometry.centre[mesh.neighbour[at]] - geometry.centre[mesh.owner[at]]
    along = _dot(step, geometry.face_area[at]) / size
    return np.asarray(size / np.maximum(along, 0.05 * np.linalg.norm(step, axis=1)))


def _dot(one: Array, other: Array) -> Array:
    return np.asarray(np.einsum("fx,fx->f", one, other))


@compiled
def _fill(
    owner: Ints,
    neighbour: Ints,
    centre: Array,
    face_centre: Array,
    area: Array,
    slots: Ints,
    places: Ints,
    gradient: Array,
    values: Array,
) -> None:
    """Add up ``values`` (e + 1,) from the cells' ``gradient`` (c, SLOTS, 3)."""
    slant = np.empty(3)
    for f in range(len(neighbour)):
        p, n = owner[f], neighbour[f]
        to_owner, to_neighbour = 0.0, 0.0
        size, along, reach = 0.0, 0.0, 0.0
        for d in range(3):
            to_owner += (face_centre[f, d] - centre[p, d]) * area[f, d]
            to_neighbour += (centre[n, d] - face_centre[f, d]) * area[f, d]
            step = centre[n, d] - centre[p, d]
            size, reach = size + area[f, d] ** 2, reach + step**2
            along += area[f, d] * step
        w = abs(to_neighbour) / (abs(to_owner) + abs(to_neighbour))
        size, reach = math.sqrt(size), math.sqrt(reach)
        stiff = size / max(along / size, 0.05 * reach)  # bounded as in OpenFOAM
        for d in range(3):
            slant[d] = area[f, d] - stiff * (centre[n, d] - centre[p, d])
        for side, cell, share in ((0, p, w), (1, n, 1.0 - w)):
            for k in range(SLOTS):
                value = 0.0
                for d in range(3):
                    value += share * slant[d] * gradient[cell, k, d]
                values[places[f, side, k, 0]] -= value
                values[places[f, side, k, 1]] += value
        for row, sign in ((0, 1.0), (1, -1.0)):
            values[places[f, 0, 0, row]] += sign * stiff
            values[places[f, 0, slots[f, 0], row]] -= sign * stiff
