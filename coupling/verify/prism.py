"""The mesh of an upright cylinder: the disc's quadrilaterals, in layers."""

from __future__ import annotations

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh, assemble
from coupling.ports import Array, Ints
from coupling.verify.disc import disc_grid


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
    return assemble(_stacked(plan, depth, layers), np.concatenate(hexes), top=-1e-9)


def _layers(faces: Ints, depth: float) -> int:
    """As many as make cells as high as they are wide."""
    return max(2, round(depth * float(np.sqrt(len(faces) / np.pi))))


def _stacked(plan: Array, depth: float, layers: int) -> Array:
    heights = np.repeat(np.linspace(0.0, -depth, layers + 1), len(plan))
    return np.column_stack([np.tile(plan, (layers + 1, 1)), heights])
