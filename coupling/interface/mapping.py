"""Displacements from the diaphragm to the flow's points, forces back by the transpose.

Points map as x_flow = N x_cloth + c and forces as F_cloth = N^T F_flow, so that work is conserved
whatever N. N and c are those of a step: the coupling iterates on a fixed linear map.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from scipy.sparse import csr_array

from coupling.ports import Array, StructureState


class StepMap(Protocol):
    """What maps cloth nodes to flow points in one step: fixed, and linear in the nodes."""

    @property
    def shell(self) -> Array | None:
        """The shell's points (s, 3) [m] at the step's end, None where they stay."""

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) [m] of cloth nodes (n, 3) [m]."""

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""

    def rows_to_cloth(self, rows: csr_array) -> Array:
        """Rows (r, n, 3) on cloth nodes of sparse rows (r, 3 p) on flow points."""


class InterfaceMap(Protocol):
    """What the coupling asks of a map: one for every step."""

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> StepMap:
        """The map of a step of ``dt`` [s] from ``state``.

        ``nodes`` (n, 3) [m]: where the structure's are expected at its end.
        """

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``; other entries are ignored."""


class Matching:
    """The map of a structure whose nodes are the flow's points, in a shell that stays."""

    shell: Array | None = None

    def begin_step(self, state: StructureState, dt: float, nodes: Array) -> Matching:
        """Return this map: it is the same in every step."""
        return self

    def to_flow(self, nodes: Array) -> Array:
        """Return the nodes themselves (p, 3) [m]."""
        return nodes

    def to_cloth(self, force: Array) -> Array:
        """Return the forces themselves (p, 3) [N]."""
        return force

    def rows_to_cloth(self, rows: csr_array) -> Array:
        """Return the rows themselves (r, p, 3), dense."""
        return rows.toarray().reshape(rows.shape[0], -1, 3)

    def save(self) -> dict[str, Array]:
        """Return no arrays: the map keeps no state."""
        return {}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Do nothing: the map keeps no state."""
