"""Self-contact within a step's iteration: planes that keep touching pairs apart."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array, Ints
from cloth.compiled import compiled
from cloth.shell.kernels import keep_within, outward_part

SWEEPS = 50  # over all planes, in every projection, at most
# Of the first sweep's largest push, below which the sweeps end. What they leave is some 1e-4 of a
# push of a few thicknesses, a fifth of a thousandth of one; four sweeps alone left up to a tenth.
PRECISION = 1e-4


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
        self,
        inverse_mass: Array,
        profile: Array,
        weight: Array,
        friction: float,
        start: Array,
        z: Array,
        u: Array,
        rub: Array,
        pressing: Array,
        rhs: Array,
    ) -> None:
        """Do ``plane_step`` with these planes, and nothing where there are none.

        Parameters
        ----------
        inverse_mass
            Inverse mass of the nodes (n,) [1/kg].
        profile
            The shell, as ``cloth.shell.kernels`` describes it.
        weight
            Penalty of the shell (n,) [N/m]; 0 leaves a node out.
        friction
            Coulomb's coefficient of the sheet on itself [-].
        start
            Positions (n, 3) [m] at the step's start.
        z, u
            Place and scaled dual (n, 3) [m] that the shell's contact left; both are changed.
        rub
            Becomes the friction that each node exerts (n, 3) [N].
        pressing
            Becomes what presses on each node (n, 2) [N]: the shell, and the sheet itself.
        rhs
            Forces (n, 3) [N], to which the change is added.
        """
        if len(self.nodes):
            plane_step(
                self.nodes, self.weights, self.normal, self.rest, inverse_mass, profile, weight,
                SWEEPS, friction, start, z, u, rub, pressing, rhs,
            )  # fmt: skip

    def joined(self, former: Planes) -> Planes:
        """Return these planes, and those ``former`` ones that part other nodes than they do."""
        known = {tuple(group) for group in self.nodes.tolist()}
        kept = np.array([tuple(group) not in known for group in former.nodes.tolist()], dtype=bool)
        return Planes(
            nodes=np.concatenate([self.nodes, former.nodes[kept]]),
            weights=np.concatenate([self.weights, former.weights[kept]]),
            normal=np.concatenate([self.normal, former.normal[kept]]),
            rest=np.concatenate([self.rest, former.rest[kept]]),
        )


@compiled
def project_planes(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    profile: Array,
    sweeps: int,
    friction: float,
    start: Array,
    z: Array,
    beyond: Array,
    rub: Array,
    pushed: Array,
) -> None:
    """See ``cloth.self_contact.planes_reference.project_planes``."""
    held = np.zeros((len(nodes), 3))
    slip, first, most = np.zeros(3), 0.0, 0.0
    for sweep in range(sweeps):
        most = 0.0
        for k in range(len(nodes)):
            gap, total = 0.0, 0.0
            for i in range(4):
                j, w = nodes[k, i], weights[k, i]
                total += inverse_mass[j] * w * w
                for d in range(3):
                    gap += w * normal[k, d] * z[j, d]
            if total <= 0.0:
                continue
            lacking = max(rest[k] - gap, -pushed[k])
            if lacking != 0.0:
                pushed[k] += lacking
                most = max(most, abs(lacking))
                for i in range(4):
                    j = nodes[k, i]
                    share = lacking * inverse_mass[j] * weights[k, i] / total
                    if share != 0.0:
                        move_within(profile, share, normal[k], z[j], beyond[j])
            if friction <= 0.0 or not (pushed[k] > 0.0 or held[k].any()):
                continue
            along = 0.0
            for d in range(3):
                slip[d] = 0.0
                for i in range(4):
                    slip[d] += weights[k, i] * (z[nodes[k, i], d] - start[nodes[k, i], d])
                along += slip[d] * normal[k, d]
            size = 0.0
            for d in range(3):
                slip[d] += held[k, d] - along * normal[k, d]
                size += slip[d] ** 2
            share = min(1.0, friction * pushed[k] / max(math.sqrt(size), 1e-300))
            for d in range(3):
                slip[d] = share * slip[d] - held[k, d]
                held[k, d] += slip[d]
                most = max(most, abs(slip[d]))
            for i in range(4):
                j = nodes[k, i]
                share = -inverse_mass[j] * weights[k, i] / total
                if share != 0.0:
                    for d in range(3):
                        rub[j, d] += share * slip[d]
                    move_within(profile, share, slip, z[j], beyond[j])
        if sweep == 0:
            first = most
        if most <= PRECISION * first:
            break


@compiled
def move_within(profile: Array, share: float, way: Array, place: Array, beyond: Array) -> None:
    """Move a point by a share of a vector, then into the shell, and keep what the shell takes.

    Parameters
    ----------
    profile
        The shell, as ``cloth.shell.kernels`` describes it.
    share
        Factor of ``way``.
    way
        Vector (3,); ``share`` times it is in m.
    place
        The point (3,) [m], which is moved.
    beyond
        What the shell took of it before (3,) [m]; becomes what it takes in all.
    """
    for d in range(3):
        beyond[d] += place[d] + share * way[d]
        place[d] = beyond[d]
    keep_within(profile, place)
    for d in range(3):
        beyond[d] -= place[d]


@compiled
def plane_step(
    nodes: Ints,
    weights: Array,
    normal: Array,
    rest: Array,
    inverse_mass: Array,
    profile: Array,
    weight: Array,
    sweeps: int,
    friction: float,
    start: Array,
    z: Array,
    u: Array,
    rub: Array,
    pressing: Array,
    rhs: Array,
) -> None:
    """See ``cloth.self_contact.planes_reference.plane_step``."""
    before, beyond, pushed = z.copy(), np.zeros_like(z), np.zeros(len(nodes))
    rub[:] = 0.0
    for i in range(len(z)):
        outward_part(profile, z[i], u[i], beyond[i])
    project_planes(
        nodes,
        weights,
        normal,
        rest,
        inverse_mass,
        profile,
        sweeps,
        friction,
        start,
        z,
        beyond,
        rub,
        pushed,
    )
    for i in range(len(z)):
        square = beyond[i, 0] ** 2 + beyond[i, 1] ** 2 + beyond[i, 2] ** 2
        pressing[i, 0], pressing[i, 1] = weight[i] * math.sqrt(square), 0.0
    for k in range(len(nodes)):
        stiffness, total = 0.0, 0.0
        for i in range(4):
            j, w = nodes[k, i], weights[k, i]
            stiffness = max(stiffness, weight[j] * inverse_mass[j])
            total += inverse_mass[j] * w * w
        for i in range(4):
            if total > 0.0:
                pressing[nodes[k, i], 1] += stiffness * abs(weights[k, i]) * pushed[k] / total
    for i in range(len(z)):
        for d in range(3):
            rub[i, d] *= -weight[i]
            if weight[i] > 0.0:
                change = z[i, d] - before[i, d]
                u[i, d] -= change
                rhs[i, d] += 2.0 * weight[i] * change
