"""How many cells the liquid's meshes have: the finest of at most so many, the next ones, a length.

Half balls come in steps of n, the cells across their cube. A long one may have up to a quarter
fewer cells along its depth than would be as long as a ball's, so that the steps are no larger.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from coupling.finite_volume.blocks import Divisions, depth_cells
from coupling.ports import Array, Shell

# Faces on the diaphragm to a node of the structure, with which a mesh holds the inertia of all its
# waves: about as many as nodes are free of the shell. With 592 nodes, of which 324 are free (fill
# fraction 0.8) or 428 (0.3), on a flow of 6,664 cells, the largest part that an iteration leaves of
# any motion, stiffness apart, is .35 or .61 with 340 faces, 1.6 or 1.7 with 224, .20 or .22 with
# 528; and a flow of 4,320 cells took as many iterations as with its own 528, 1.90 of 20 steps, with
# 340 and 2.00 with 224.
FACES = 0.55
# Cells along a long half ball's depth, at least, over those that are as long as a ball's. With 0.6
# the patch of at most 2300 and 4320 cells is finer in a pill of 2:1 that is 3 R deep, 224 and 340
# faces for 132 and 224, and omega^2 of its lowest wave errs by more, 1.7 and 1.1 % for 1.2 and 0.7.
FEWEST = 0.75
SAMPLES = 401  # of the meridian, for its largest radius
DIGITS = 2  # of a half ball's length: what is less is rounding, or moves no cell
LONGEST = 3.0  # half ball's length: deeper liquid has longer cells, far below its waves


@dataclass(frozen=True, kw_only=True)
class Size:
    """A half ball of ``n`` cells across its cube and ``depth`` along its depth, so divided."""

    n: int
    depth: int
    divisions: Divisions


def _size(n: int, depth: int, spacing: float, length: float) -> Size:
    return Size(n=n, depth=depth, divisions=Divisions.of(n, spacing, length, depth))


def _depths(n: int, length: float) -> range:
    """Numbers of cells that the depth may have."""
    most = depth_cells(n, length)
    return range(max(n // 2, math.ceil(FEWEST * most)), most + 1)


def finest(cells: int, spacing: float = 0.0, length: float = 0.0) -> Size:
    """Return the finest half ball of at most so many cells; parameters as of ``half_ball``.

    The most across its cube, and with those the most along its depth. Raises ValueError where even
    the coarsest has more cells.
    """
    n, taken = 2, _size(2, _depths(2, length)[0], spacing, length)
    if taken.divisions.cells > cells:
        raise ValueError(f"the coarsest mesh has {taken.divisions.cells} cells, got {cells}")
    while True:
        for depth in _depths(n, length):
            tried = _size(n, depth, spacing, length)
            if tried.divisions.cells > cells:
                break
            taken = tried
        if taken.n < n:
            return taken
        n += 2


def cells_least(n: int, spacing: float = 0.0, length: float = 0.0) -> int:
    """The fewest cells of a half ball with ``n`` across its cube, else as of ``half_ball``."""
    return _size(n, _depths(n, length)[0], spacing, length).divisions.cells


def cells_made(cells: int, spacing: float = 0.0, length: float = 0.0) -> int:
    """How many cells ``half_ball(cells, spacing, length)`` has."""
    return finest(cells, spacing, length).divisions.cells


def cells_above(cells: int, spacing: float = 0.0, length: float = 0.0) -> int:
    """How many cells the next finer mesh than ``half_ball(cells, spacing, length)`` has."""
    own = finest(cells, spacing, length)
    if own.depth < _depths(own.n, length)[-1]:
        return Divisions.of(own.n, spacing, length, own.depth + 1).cells
    return cells_least(own.n + 2, spacing, length)


def cells_halved(cells: int, spacing: float = 0.0, length: float = 0.0) -> int:
    """Cells of the coarser half ball that comes nearest to half those of ``half_ball``.

    Its cells at the walls are as high, and its depth has as many for those across its cube, to a
    whole one. Parameters as of ``half_ball``.
    """
    own = finest(cells, spacing, length)
    coarser = [
        Divisions.of(n, spacing, length, round(own.depth * n / own.n)).cells
        for n in range(2, own.n, 2)
    ] or [own.divisions.cells]
    return min(coarser, key=lambda size: abs(math.log(2.0 * size / own.divisions.cells)))


def coarsest_for(nodes: int, of: Divisions) -> Divisions:
    """The coarsest half ball, as long as ``of``, that is as fine as a structure of ``nodes``.

    Its diaphragm has ``FACES`` faces to a node at least; its cells are not graded towards walls,
    and there are no more along its depth than along that of ``of``.
    """
    n, length = 2, of.length
    while Divisions.of(n, 0.0, length).top < FACES * nodes:
        n += 2
    return Divisions.of(n, 0.0, length, min(depth_cells(n, length), len(of.depth) - 1))


def length_for(shell: Shell, up: Array, fill_fraction: float) -> float:
    """Return by how much the half ball's depth is to be longer than a ball's, over its radius.

    That by which the tank is longer than its largest width, as much of it as is filled, and as
    much as stands upright: a lying tank's liquid is no deeper than a ball's. Of a sphere 0.

    Parameters
    ----------
    shell
        The tank's.
    up
        Against gravity (3,), of any length, in the tank's axes; 0 stands for a lying tank.
    fill_fraction
        Of the tank [-].

    Returns
    -------
    float
        The length [-], to two digits behind the point, at most ``LONGEST``.
    """
    low, high = shell.poles
    arcs = np.linspace(shell.arc_to(low), shell.arc_to(high), SAMPLES)
    longer = (high - low) / float(shell.along(arcs)[0].max()) - 2.0
    upright = abs(float(up[2])) / (float(np.linalg.norm(up)) or math.inf)
    return min(LONGEST, max(0.0, round(longer * fill_fraction * upright, DIGITS)))
