"""An upright prism over a grid of quadrilaterals: its boundary as panels, its inside as a mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coupling.foam.mesh import LiquidMesh, _assemble
from coupling.ports import Array, Ints
from coupling.verify.disc import disc_grid


def prism_panels(plan: Array, faces: Ints, depth: float) -> tuple[Array, Ints]:
    """Points (P, 3) and panels (N, 4) of the prism from z = 0 down to -``depth``.

    Over the grid of ``plan`` (p, 2) and ``faces`` (F, 4). The first F panels, on the first p
    points, are the top; then come the wall and the bottom, all seen from outside.
    """
    layers = _layers(faces, depth)
    points = _stacked(plan, depth, layers)
    count = len(plan)
    start, end = _rim(faces).T
    wall = [
        np.stack([start + k * count, start + (k + 1) * count, end + (k + 1) * count,
                  end + k * count], axis=1)
        for k in range(layers)
    ]  # fmt: skip
    return points, np.concatenate([faces, *wall, faces[:, ::-1] + layers * count])


def prism_mesh(cells: int, depth: float) -> LiquidMesh:
    """The finest mesh of at most ``cells`` hexahedra in a cylinder of radius 1 and ``depth``.

    Its top, at z = 0, is the patch ``diaphragm``.
    """
    faces, (plan, quads) = 12, disc_grid(12)
    while True:
        finer = disc_grid(faces)
        if len(finer[1]) * _layers(finer[1], depth) > cells:
            break
        (plan, quads), faces = finer, faces + 20
    layers, count = _layers(quads, depth), len(plan)
    hexes = [
        np.concatenate([quads + (k + 1) * count, quads + k * count], axis=1) for k in range(layers)
    ]
    mesh = _assemble(_stacked(plan, depth, layers), np.concatenate(hexes), top=-1e-9)
    return replace(mesh, moulded=mesh.points[mesh.patch_points])


def _layers(faces: Ints, depth: float) -> int:
    """As many as make cells as high as they are wide."""
    return max(2, round(depth * float(np.sqrt(len(faces) / np.pi))))


def _stacked(plan: Array, depth: float, layers: int) -> Array:
    heights = np.repeat(np.linspace(0.0, -depth, layers + 1), len(plan))
    return np.column_stack([np.tile(plan, (layers + 1, 1)), heights])


def _rim(faces: Ints) -> Ints:
    """Border (E, 2) of ``faces`` (F, 4), its edges in their sense of rotation."""
    sides = np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2)
    _, group, number = np.unique(
        np.sort(sides, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    return np.asarray(sides[number[group.ravel()] == 1])
