"""OpenFOAM's ``Gauss linear`` gradients of the cells, and the pressure on the walls beside them.

From a cell's centre to its face on a wall the pressure changes along the normal as the wall's
acceleration asks, and along the wall by the cell's own gradient, as in the walls' library. The
latter counts as much as the former where the mesh leans: in a wedge a cell's centre lies half its
height beside its face's. It is taken no further than the cell's height goes, and not where a cell
has two walls, whose values would be its own gradient's: the order is the first there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from cloth.compiled import compiled
from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array, Ints

SLOTS = 7  # of a gradient: a hexahedron and its neighbours


@dataclass(frozen=True, kw_only=True)
class Stencils:
    """Which cells take part in a cell's gradient.

    ``columns`` (c, SLOTS): the cell and its neighbours, itself again where there are less;
    ``slots`` (inner, 2): where either cell of a face stands in the other's columns.
    """

    columns: Ints
    slots: Ints


def stencils(mesh: LiquidMesh) -> Stencils:
    """Return the stencils of ``mesh``; they are found once for each topology."""
    return stencils_of(mesh.owner.tobytes(), mesh.neighbour.tobytes(), mesh.cells)


@lru_cache(maxsize=4)
def stencils_of(owner: bytes, neighbour: bytes, cells: int) -> Stencils:
    """Return the stencils of ``cells`` with these ``owner`` and ``neighbour``, int64 as bytes."""
    owners, neighbours = np.frombuffer(owner, np.int64), np.frombuffer(neighbour, np.int64)
    columns = np.repeat(np.arange(cells)[:, None], SLOTS, axis=1)
    slots, count = np.empty((len(neighbours), 2), np.int64), np.ones(cells, np.int64)
    pairs = np.stack([owners[: len(neighbours)], neighbours], axis=1)
    for face, pair in enumerate(pairs):
        slots[face] = count[pair]
        columns[pair, count[pair]] = pair[::-1]
        count[pair] += 1
    return Stencils(columns=columns, slots=slots)


@dataclass(frozen=True, kw_only=True)
class Gradients:
    """Gradients and wall values as sums over the cells' ``columns`` (c, SLOTS).

    ``cells`` (c, SLOTS, 3) [1/m] and ``walls`` (B, SLOTS): weights of the columns' values. What the
    wall's acceleration adds to them stands apart. Exact for a linear field but for the skewness of
    the faces inside, and beside the walls where the module says.
    """

    columns: Ints
    cells: Array
    walls: Array

    def on_walls(self, own: Ints, values: Array) -> Array:
        """Return the values of a field on the walls, without what it changes by along the normals.

        Parameters
        ----------
        own
            Cells of the faces on the walls (B,).
        values
            Values of the field in the cells (c,), of any unit.

        Returns
        -------
        Array
            Values on the walls (B,), in the unit of ``values``.
        """
        return np.asarray(np.einsum("bk,bk->b", self.walls, values[self.columns[own]]))


def gradients(mesh: LiquidMesh, geometry: CellGeometry) -> Gradients:
    """Return gradients and wall values of the cells of ``mesh`` at ``geometry``."""
    found = stencils(mesh)
    cells = np.zeros((mesh.cells, SLOTS, 3))
    walls = np.zeros((len(mesh.owner) - mesh.inner_faces, SLOTS))
    _gather(
        mesh.owner, mesh.neighbour, geometry.volume, geometry.centre,
        geometry.face_centre, geometry.face_area, found.slots, cells, walls,
    )  # fmt: skip
    return Gradients(columns=found.columns, cells=cells, walls=walls)


def wall_distance(mesh: LiquidMesh, geometry: CellGeometry) -> Array:
    """Return the distances (F,) [m] between the diaphragm's faces and the centres of their cells.

    They are taken along the faces' normals.
    """
    area = geometry.face_area[mesh.diaphragm]
    reach = geometry.face_centre[mesh.diaphragm] - geometry.centre[mesh.owner[mesh.diaphragm]]
    return np.asarray(np.abs(np.einsum("fx,fx->f", reach, area)) / np.linalg.norm(area, axis=1))


def wall_pressure(mesh: LiquidMesh, geometry: CellGeometry, pressure: Array, rate: Array) -> Array:
    """Return the pressure of the cells carried on to the walls, less its mean over the diaphragm.

    The shell is taken to be at rest.

    Parameters
    ----------
    mesh
        The mesh, of c cells and B faces on the walls, the diaphragm's F first.
    geometry
        Where its cells stand.
    pressure
        Pressure over density in the cells (c,) [m^2/s^2].
    rate
        Rate of change of the flux of the diaphragm's faces, d(flux)/dt (F,) [m^3/s^2].

    Returns
    -------
    Array
        Pressure over density on the walls (B,) [m^2/s^2].
    """
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    wall = gradients(mesh, geometry).on_walls(mesh.owner[mesh.inner_faces :], pressure)
    wall[: len(rate)] -= wall_distance(mesh, geometry) * rate / area
    return np.asarray(wall - float(wall[: len(rate)] @ area / area.sum()))


@compiled
def _gather(
    owner: Ints,
    neighbour: Ints,
    volume: Array,
    centre: Array,
    face_centre: Array,
    area: Array,
    slots: Ints,
    cells: Array,
    walls: Array,
) -> None:
    """Fill ``cells`` (c, SLOTS, 3) and ``walls`` (B, SLOTS), zero before."""
    inner = len(neighbour)
    for f in range(inner):
        p, n = owner[f], neighbour[f]
        to_owner, to_neighbour = 0.0, 0.0
        for d in range(3):
            to_owner += (face_centre[f, d] - centre[p, d]) * area[f, d]
            to_neighbour += (centre[n, d] - face_centre[f, d]) * area[f, d]
        w = abs(to_neighbour) / (abs(to_owner) + abs(to_neighbour))
        for d in range(3):
            cells[p, 0, d] += w * area[f, d] / volume[p]
            cells[p, slots[f, 0], d] += (1.0 - w) * area[f, d] / volume[p]
            cells[n, 0, d] -= (1.0 - w) * area[f, d] / volume[n]
            cells[n, slots[f, 1], d] -= w * area[f, d] / volume[n]
    count = walls.shape[0]
    own = owner[inner:]
    faces = np.zeros(len(volume), np.int64)
    for b in range(count):
        faces[own[b]] += 1
    aside = np.zeros(3)
    for b in range(count):
        f, p, along, size = inner + b, own[b], 0.0, 0.0
        for d in range(3):
            along += (face_centre[f, d] - centre[p, d]) * area[f, d]
            size += area[f, d] ** 2
        for d in range(3):
            aside[d] = face_centre[f, d] - centre[p, d] - along / size * area[f, d]
        lean = math.sqrt(size * (aside[0] ** 2 + aside[1] ** 2 + aside[2] ** 2)) / abs(along)
        share = min(1.0, 1.0 / lean) if faces[p] == 1 else 0.0
        walls[b, 0] = 1.0
        for k in range(SLOTS):
            for d in range(3):
                walls[b, k] += share * aside[d] * cells[p, k, d]
    for b in range(count):
        f, p = inner + b, own[b]
        for k in range(SLOTS):
            for d in range(3):
                cells[p, k, d] += walls[b, k] * area[f, d] / volume[p]
