"""The liquid's hexahedral mesh: the lower half of a cubed ball, whose top is the diaphragm.

Its points are those of ``blocks``. The top is the patch ``diaphragm``, a disc; its rim is where the
liquid's surface meets the shell, anywhere on it, at the angle that a liquid's surface has there.
The topology never changes in a run. Where the points go as the diaphragm moves is the business of
``free_patch`` and ``following``.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from coupling.finite_volume.blocks import Divisions, half_blocks
from coupling.finite_volume.mesh_sizes import finest
from coupling.ports import Array, Ints

# Faces of a hexahedron, seen counter-clockwise from outside, and its edges.
_FACES = np.array(
    [(0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)]
)
_EDGES = np.array(
    [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
)


@dataclass(frozen=True, kw_only=True)
class LiquidMesh:
    """Topology in OpenFOAM's order, and the reference half ball of radius 1.

    ``points`` (P, 3); ``faces`` (F, 4), first the inner ones, then the patch ``diaphragm``, then
    ``shell``; ``owner`` (F,), ``neighbour`` (inner,); ``hexes`` (c, 8). ``divisions``: of a half
    ball's blocks, None of any other mesh.
    """

    points: Array
    faces: Ints
    owner: Ints
    neighbour: Ints
    cells: int
    diaphragm_faces: int
    hexes: Ints = field(repr=False)
    divisions: Divisions | None = None

    @property
    def inner_faces(self) -> int:
        """Number of faces between two cells."""
        return len(self.neighbour)

    @property
    def diaphragm(self) -> slice:
        """Faces of the patch ``diaphragm``."""
        return slice(self.inner_faces, self.inner_faces + self.diaphragm_faces)

    @property
    def shell(self) -> slice:
        """Faces of the patch ``shell``."""
        return slice(self.inner_faces + self.diaphragm_faces, len(self.faces))

    @cached_property
    def edges(self) -> Ints:
        """Edges (E, 2) of all cells, each once."""
        return np.unique(np.sort(self.hexes[:, _EDGES].reshape(-1, 2), axis=1), axis=0)

    @cached_property
    def patch_points(self) -> Ints:
        """Points of the patch ``diaphragm``, rim included (p,)."""
        return np.unique(self.faces[self.diaphragm])

    @cached_property
    def patch_faces(self) -> Ints:
        """Faces of the patch in the numbering of ``patch_points`` (F, 4), seen from the gas."""
        return np.searchsorted(self.patch_points, self.faces[self.diaphragm])

    @cached_property
    def rim(self) -> NDArray[np.bool_]:
        """Which of ``patch_points`` lie on the rim (p,)."""
        return np.isin(self.patch_points, np.unique(self.faces[self.shell]))

    @cached_property
    def shell_points(self) -> Ints:
        """Points of the patch ``shell`` without the rim (s,)."""
        return np.setdiff1d(self.faces[self.shell], self.patch_points)


def half_ball(cells: int, spacing: float = 0.0, length: float = 0.0) -> LiquidMesh:
    """Return the finest lower half of a cubed ball of at most so many cells.

    Parameters
    ----------
    cells
        Most cells.
    spacing
        Height of the cells at shell and disc over the radius, at most [-]; 0, or more than theirs
        without it, for cells that are not graded towards them.
    length
        Of a cylinder between the half ball and the disc, over the radius [-].

    Returns
    -------
    LiquidMesh
        The mesh, n cells across its cube, n even, and 0.65 n layers or, graded, more.

    Raises
    ------
    ValueError
        Even the coarsest mesh has more cells.
    """
    return divided(finest(cells, spacing, length).divisions)


def divided(divisions: Divisions) -> LiquidMesh:
    """The half ball whose blocks are divided so."""
    blocks = half_blocks(divisions)
    return replace(assemble(blocks.points, blocks.hexes, top=-1e-9), divisions=divisions)


def shell_shares(reach: Array, arc: Array | float, room: Array | float | None = None) -> Array:
    """Return where the shell's points stand on the arcs from the pool's middle to its rim.

    Where the pool closes above its equator the patch is small for the arc, and so are its cells:
    the shell's points are denser towards the rim, half as much as the patch's. As dense as those
    they would serve a level surface better, but in violent sway the cells at the rim collapse.

    Parameters
    ----------
    reach
        Shares of the arc at which the points stand in the half ball (s,) [-], from 0 to 1.
    arc
        Angle between middle and rim, one for all points or of each (s,) [rad], in (0, pi).
    room
        The patch's radius over the arc's length, over the same in the half ball [-], one for all
        points or of each (s,); None for that of a sphere.

    Returns
    -------
    Array
        Shares of the arc (s,) [-], from 0 at the middle to 1 at the rim.
    """
    if room is None:
        room = 0.5 * np.pi * np.sin(arc) / arc
    dense = np.sqrt(np.minimum(1.0, room))
    return np.asarray(reach + (1.0 - dense) * reach * (1.0 - reach))


def assemble(points: Array, hexes: Ints, *, top: float) -> LiquidMesh:
    """Return the mesh of given hexahedra, with its faces in OpenFOAM's order.

    Whether the hexahedra meet face to face, and are not turned inside out, is not checked.

    Parameters
    ----------
    points
        All points (P, 3), in the mesh's own unit of length.
    hexes
        Corners of the hexahedra (c, 8), in OpenFOAM's order.
    top
        Height z, in that unit: border faces whose centre lies above it are the diaphragm's, the
        others the shell's.

    Returns
    -------
    LiquidMesh
        The mesh, at its reference.
    """
    flat = hexes[:, _FACES].reshape(-1, 4)
    cell = np.repeat(np.arange(len(hexes)), 6)
    _, group, count = np.unique(
        np.sort(flat, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.lexsort((cell, group.ravel()))
    twin = count[group.ravel()[order]] == 2
    pairs = order[twin].reshape(-1, 2)  # the same face from both cells, the lower cell first
    owner, neighbour = cell[pairs].T
    sort = np.lexsort((neighbour, owner))
    outer = np.sort(order[~twin])
    above = points[flat[outer]].mean(axis=1)[:, 2] > top
    patches = (outer[above], outer[~above])
    return LiquidMesh(
        points=points,
        faces=np.concatenate([flat[pairs[sort, 0]], *(flat[p] for p in patches)]),
        owner=np.concatenate([owner[sort], *(cell[p] for p in patches)]),
        neighbour=neighbour[sort],
        cells=len(hexes),
        diaphragm_faces=len(patches[0]),
        hexes=hexes,
    )
