"""Self-contact within a step's iteration: planes that keep touching pairs apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cloth.arrays import Array, Ints
from cloth.compiled import compiled

SWEEPS = 4  # over all planes, in every projection


@dataclass(frozen=True, kw_only=True)
class Planes:
    """Half-spaces n . sum_i w_i x_i >= rest, one for every touching pair.

    ``nodes`` (k, 4), ``weights`` (k, 4), ``normal`` (k, 3) of unit length, ``rest`` (k,) [m].
    """

    nodes: Ints
    weights: Array
    normal: Array
    rest: Array

    def step(
        self, inverse_mass: Array, limit: Array, weight: Array, z: Array, u: Array, rhs: Array
    ) -> None:
        """``plane_step`` with these planes."""
        if len(self.nodes):
            plane_step(
                self.nodes, self.weights, self.normal, self.rest,
                inverse_mass, limit, weight, SWEEPS, z, u, rhs,
            )  # fmt: skip


@compiled
def project_planes(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    limit: Array,
    sweeps: int,
    z: Array,
) -> None:
    """See ``cloth.self_contact.reference.project_planes``."""
    for _ in range(sweeps):
        for k in range(len(nodes)):
            gap, total = 0.0, 0.0
            for i in range(4):
                j, w = nodes[k, i], weights[k, i]
                total += inverse_mass[j] * w * w
                for d in range(3):
                    gap += w * normal[k, d] * z[j, d]
            if gap >= rest[k] or total <= 0.0:
                continue
            for i in range(4):
                j = nodes[k, i]
                share = (rest[k] - gap) * inverse_mass[j] * weights[k, i] / total
                if share == 0.0:
                    continue
                square = 0.0
                for d in range(3):
                    z[j, d] += share * normal[k, d]
                    square += z[j, d] * z[j, d]
                scale = min(1.0, limit[j] / max(math.sqrt(square), 1e-30))
                for d in range(3):
                    z[j, d] *= scale


@compiled
def plane_step(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    limit: Array,
    weight: Array,
    sweeps: int,
    z: Array,
    u: Array,
    rhs: Array,
) -> None:
    """See ``cloth.self_contact.reference.plane_step``."""
    before = z.copy()
    project_planes(nodes, weights, normal, rest, inverse_mass, limit, sweeps, z)
    for i in range(len(z)):
        if weight[i] > 0.0:
            for d in range(3):
                change = z[i, d] - before[i, d]
                u[i, d] -= change
                rhs[i, d] += 2.0 * weight[i] * change
