"""One step's map from the diaphragm's nodes to the points of the flow's patch, fixed and linear.

Interpolation alone would lose volume where the patch is coarser than the sheet's waves, and all of
it in the strip between a fixed rim and the points next to it. Within a step every node therefore
displaces exactly the volume that its own triangles sweep: what interpolation misses lifts the patch
beside it, and at the rim climbs the shell. In return a node bears the pressure on its own area.
Only where faces are pressed together, at the bottom of a crease, is it less of both.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.sparse import csr_array

from coupling.finite_volume.swept import cross, swept_gradient
from coupling.interface.weights import Sources, Support, moving_least_squares
from coupling.ports import Array, Ints


@dataclass(frozen=True, kw_only=True)
class Lift:
    """How the patch rises by the volume that interpolation misses of the sheet's.

    ``way`` (p, 3): unit vectors along which points rise, ``opened`` (p,) [m^2]: the volume that
    this opens per length; ``missed`` (n, 3) [m^2]: volume per displacement of every node that
    interpolation misses; ``shares`` (n, p): to which points it goes.
    """

    way: Array
    opened: Array
    missed: Array
    shares: Array

    def heights(self, displacement: Array) -> Array:
        """By how much the points rise (p,) [m] for nodes displaced by ``displacement`` (n, 3)."""
        missed = np.einsum("nx,nx->n", self.missed, displacement)
        return np.asarray((self.shares.T @ missed) / self.opened)

    def transpose(self, rise: Array | csr_array) -> Array:
        """Rows (r, n, 3) on the nodes of rows (r, p) on the heights."""
        return np.asarray((rise @ (self.shares / self.opened).T)[:, :, None] * self.missed)


@dataclass(frozen=True, kw_only=True)
class PatchMap:
    """What maps the sheet to the patch in one step.

    ``shell`` (s, 3) [m]: where the shell's points end the step. ``nodes`` (n, 3) [m]: where the
    sheet's are expected then; ``weights`` N (p, n) and ``offset`` (p, 3) [m] put the patch there.
    ``face_directions`` (F, 3) and ``node_directions`` (n, 3): the patch's faces and the nodes,
    as far as they lie within the contact curve, on the unit hemisphere, with the ``support`` of
    the weights between them.
    """

    shell: Array
    nodes: Array
    weights: Array
    offset: Array
    lift: Lift
    face_directions: Array
    node_directions: Array
    support: Support

    def to_flow(self, nodes: Array) -> Array:
        """Flow points (p, 3) [m] of cloth nodes (n, 3) [m]."""
        height = self.lift.heights(nodes - self.nodes)
        points: Array = self.weights @ nodes + self.offset + height[:, None] * self.lift.way
        return points

    def to_cloth(self, force: Array) -> Array:
        """Nodal forces (n, 3) [N] of forces on flow points (p, 3) [N]."""
        nodal = self.weights.T @ force
        rise = np.einsum("px,px->p", force, self.lift.way)
        return np.asarray(nodal + self.lift.transpose(rise[None])[0])

    def rows_to_cloth(self, rows: csr_array) -> Array:
        """Rows (r, n, 3) on cloth nodes of sparse rows (r, 3 p) on flow points."""
        parts = [csr_array(rows[:, axis::3]) for axis in range(3)]
        ways = zip(parts, self.lift.way.T, strict=True)
        rise = csr_array(sum(part.multiply(way) for part, way in ways))
        through = np.stack([part @ self.weights for part in parts], axis=2)
        return np.asarray(through + self.lift.transpose(rise))

    def to_nodes(self, values: Array) -> Array:
        """Values (n, k) at the nodes of ``values`` (F, k) on the patch's faces.

        Where the sheet lies on the shell they are those of the contact curve beside it.
        """
        return np.asarray(self._node_weights @ values)

    @cached_property
    def _node_weights(self) -> Array:
        return moving_least_squares(
            Sources(self.face_directions).beside(self.node_directions, self.support), self.support
        )


def patch_area(points: Array, faces: Ints) -> Array:
    """Return the volume that the patch sweeps per displacement of each of its points.

    Parameters
    ----------
    points
        Points of the patch (p, 3) [m].
    faces
        Corners of its faces (F, 4), counter-clockwise seen from the gas.

    Returns
    -------
    Array
        Area vectors (p, 3) [m^2], along the normals.
    """
    area = np.zeros_like(points)
    np.add.at(area, faces, swept_gradient(points[faces]))
    return area


def node_area(nodes: Array, triangles: Ints) -> Array:
    """Return the volume that the sheet sweeps per displacement of each of its nodes.

    Parameters
    ----------
    nodes
        Nodes of the sheet (n, 3) [m].
    triangles
        Nodes of each triangle (m, 3), counter-clockwise seen from the gas.

    Returns
    -------
    Array
        Area vectors (n, 3) [m^2]: a third of those of the triangles around a node.
    """
    area = np.zeros_like(nodes)
    a, b, c = (nodes[triangles[:, k]] for k in range(3))
    np.add.at(area, triangles, (cross(b - a, c - a) / 6.0)[:, None])
    return area
