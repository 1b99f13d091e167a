"""Where the flow's mesh stands."""

from __future__ import annotations

from dataclasses import dataclass

from coupling.finite_volume.geometry import CellGeometry
from coupling.ports import Array


@dataclass(frozen=True, kw_only=True)
class MeshShape:
    """Where the mesh stands: ``points`` (P, 3) [m], their cells, and the ``patch`` (p, 3) [m]."""

    points: Array
    geometry: CellGeometry
    patch: Array
