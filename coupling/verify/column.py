"""A straight column of liquid between two pistons."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh, assemble

LENGTH, WIDTH = 1.0, 0.25  # [m]


def column_mesh(cells: int) -> LiquidMesh:
    """A column of length 1 along z, ``cells`` cubes long and as many wide as its width asks for.

    Both its ends are the patch ``diaphragm``.
    """
    across = max(2, round(cells * WIDTH / LENGTH))
    counts = np.array([across, across, cells])
    grid = np.stack(np.meshgrid(*(np.arange(n + 1) for n in counts), indexing="ij"), axis=-1)
    points = ((grid / counts - 0.5) * (WIDTH / LENGTH, WIDTH / LENGTH, 1.0)).reshape(-1, 3)
    index = np.arange(len(points)).reshape(grid.shape[:3])
    corners = [
        index[i : i + across, j : j + across, k : k + cells]
        for i, j, k in ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0),
                        (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))
    ]  # fmt: skip
    # What lies above 0.5 is the patch: of the distances from the middle these are the ends alone.
    mesh = assemble(np.abs(points), np.stack(corners, axis=-1).reshape(-1, 8), top=0.5 - 1e-9)
    return replace(mesh, points=points)
