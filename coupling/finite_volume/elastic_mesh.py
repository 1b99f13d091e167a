"""Interior points of the flow's mesh as the rest state of an elastic solid that cannot invert.

Every corner of every hexahedron is a small neo-Hookean body whose natural shape is that of the
reference half ball (Garanzha et al., ACM Trans. Graph. 40, 2021): energy
f/(3 d^(2/3)) + VOLUME (d/s + s/d)/2 with f = |T|^2, d = det T of the corner's map T from the
reference and s the mean change of volume. It rises without bound as a corner flattens, so that a
mesh which starts valid stays valid wherever the boundary allows one. A mesh that does not start so
is untangled: 1/d is put off to 2/(d + (d^2 + e^2)^(1/2)), for an e that shrinks.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.sparse import coo_array, csr_array

from cloth.compiled import compiled
from coupling.finite_volume.coarsening import prolongations
from coupling.finite_volume.corner_energy import FLATTEST, corner_energy
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.multigrid import Multigrid
from coupling.ports import Array, Ints

VOLUME = 0.1  # weight of a corner's volume against its shape: a small patch has small cells below
MEMORY = 8  # pairs of the quasi-Newton method
SPLITS = 32  # most parts that a boundary's displacement is cut into
TOLERANCE = 1e-2  # residual force over its start
ITERATIONS = 60
# Of the energy, of its sum over some 1e5 corners: what a step may gain without being refused, or a
# small motion's steps would be halved to nothing (Hager & Zhang, SIAM J. Optim. 16, 2005).
ROUNDING = 1e-13
UNTANGLINGS = 10  # values of e, at most
# Points inside up to which the Laplacian is factorised: a solve of 1,032 takes .3 ms either way,
# of 3,877 3.1 against 1.4 ms by a cycle of multigrid, of 18,342 21 against 6.
DIRECT = 2000
CYCLES = 4  # of those by which points are carried: 6e-4 of the way is left, in the energy norm


class MeshFolds(Exception):  # noqa: N818 - named for what happens
    """No valid mesh was found inside a boundary."""


class ElasticMesh:
    """Relaxes the interior points of ``mesh``; ``size`` [m] is the radius of its reference."""

    def __init__(self, mesh: LiquidMesh, size: float) -> None:
        reference = size * mesh.points
        self.corners: Ints = np.ascontiguousarray(mesh.hexes[:, _NEIGHBOURS].reshape(-1, 4))
        edges = reference[self.corners[:, 1:]] - reference[self.corners[:, :1]]
        self._inverse = np.ascontiguousarray(np.linalg.inv(np.swapaxes(edges, 1, 2)))
        boundary = np.unique(mesh.faces[mesh.inner_faces :])
        self.interior = np.setdiff1d(np.arange(len(reference)), boundary)
        self.boundary = boundary
        self._imposed = np.flatnonzero(np.isin(self.corners, boundary).all(axis=1))
        first, second = mesh.edges.T
        weight = 1.0 / np.sum((reference[first] - reference[second]) ** 2, axis=1)
        weight = np.tile(weight, 2)
        rows, columns = np.r_[first, second], np.r_[second, first]
        shape = (len(reference),) * 2
        diagonal = (np.arange(shape[0]),) * 2
        stiffness = coo_array((np.bincount(rows, weight), diagonal), shape=shape)
        block = csr_array(stiffness - coo_array((weight, (rows, columns)), shape=shape))
        block = csr_array(block[self.interior])
        self._laplacian = Multigrid(
            csr_array(block[:, self.interior]), prolongations(mesh, self.interior, DIRECT)
        )
        self._coupling = csr_array(block[:, boundary])

    def relax(self, start: Array, boundary: Array, *, size: float) -> Array:
        """Return the mesh's points with those inside at rest, to ``TOLERANCE`` of the force.

        Where the interior cannot simply follow from the start, the boundary's displacement is cut
        into parts, and where that fails too, as it must if the start is not valid, the mesh is
        untangled.

        Parameters
        ----------
        start
            Points (P, 3) [m] to begin from.
        boundary
            Points (P, 3) [m], of which only those on the boundary count: they are imposed.
        size
            Volume of the mesh over that of the reference [-].

        Returns
        -------
        Array
            Points (P, 3) [m], no corner inverted.

        Raises
        ------
        MeshFolds
            No valid mesh is found, or the boundary alone inverts a corner.
        """
        imposed = boundary[self.boundary]
        if (
            not np.isfinite(imposed).all()
            or self._least(boundary, self._imposed) <= FLATTEST * size
        ):
            raise MeshFolds
        points = self._carried(start, boundary, size)
        if points is None:
            points = self._untangled(self.carried(start, boundary), size)
        points[self.boundary] = imposed
        return points

    def _carried(self, start: Array, boundary: Array, size: float) -> Array | None:
        """``relax``, valid from the ``start`` on; None where it cannot be."""
        points, shift = start.copy(), boundary[self.boundary] - start[self.boundary]
        done, part = 0.0, 1.0
        while done < 1.0:
            after = min(1.0, done + part)
            goal = points.copy()
            goal[self.boundary] = start[self.boundary] + after * shift
            relaxed = self._minimise(self.carried(points, goal), size)
            if relaxed is not None:
                points, done = relaxed, after
            elif part > 1.0 / SPLITS:
                part /= 2.0
            else:
                return None
        return points

    def _untangled(self, points: Array, size: float) -> Array:
        """Points (P, 3) at rest, from ``points`` (P, 3) of which some corners are inverted.

        Raises ``MeshFolds`` where the least d is not brought above 0.
        """
        e = size
        for _ in range(UNTANGLINGS):
            relaxed = self._minimise(points, size, e)
            if relaxed is None:  # its energy is out of all range
                raise MeshFolds
            points, least = relaxed, self._least(relaxed, slice(None))
            if least > FLATTEST * size:
                valid = self._minimise(points, size)
                assert valid is not None, "no corner is inverted"
                return valid
            # The e with which what stands for the least d shrinks to a fifth (Garanzha et al.).
            aim = 0.1 * (least + math.hypot(least, e))
            e = 2.0 * math.sqrt(aim * (aim - least))
        raise MeshFolds

    def _least(self, points: Array, which: slice | Ints) -> float:
        """Least d among corners, with all of them at ``points`` (P, 3)."""
        corners = self.corners[which]
        edges = points[corners[:, 1:]] - points[corners[:, :1]]
        return float((np.linalg.det(edges) * np.linalg.det(self._inverse[which])).min())

    def carried(self, points: Array, boundary: Array) -> Array:
        """Return the points with the interior following the boundary harmonically, which is linear.

        Parameters
        ----------
        points, boundary
            Points (P, 3) [m] to begin from, and to end at, of which only those on the boundary
            count.

        Returns
        -------
        Array
            Points (P, 3) [m]; corners may be inverted.
        """
        moved = boundary[self.boundary] - points[self.boundary]
        answer = points.copy()
        answer[self.boundary] += moved
        pulled = np.asarray(self._coupling @ moved)
        answer[self.interior] -= self._laplacian.solve(pulled, CYCLES)
        return answer

    def _minimise(self, points: Array, size: float, e: float = 0.0) -> Array | None:
        """L-BFGS with the mesh's Laplacian as first guess of the Hessian; None when inverted."""
        gradient = np.empty_like(points)

        def evaluate(at: Array) -> tuple[float, Array]:
            energy = corner_energy(at, self.corners, self._inverse, size, VOLUME, e, gradient)
            return energy, gradient[self.interior].copy()

        energy, force = evaluate(points)
        if not np.isfinite(energy):
            return None
        rounding = ROUNDING * abs(energy)
        pairs: list[tuple[Array, Array, float]] = []
        goal = TOLERANCE * float(np.linalg.norm(force))
        for _ in range(ITERATIONS):
            if np.linalg.norm(force) <= goal:
                break
            direction = self._direction(force, pairs)
            slope = float(np.vdot(direction, force))
            length = 1.0
            while True:
                trial = points.copy()
                trial[self.interior] += length * direction
                energy_trial, force_trial = evaluate(trial)
                if energy_trial <= energy + 1e-4 * length * slope + rounding:
                    break
                length *= 0.5
                if length < 1e-6:
                    return points  # rounding: no descent is left
            step, change = length * direction, force_trial - force
            curvature = float(np.vdot(step, change))
            if curvature > 0:
                pairs = [*pairs[-MEMORY + 1 :], (step, change, curvature)]
            points, energy, force = trial, energy_trial, force_trial
        return points

    def _direction(self, force: Array, pairs: list[tuple[Array, Array, float]]) -> Array:
        """-H force by the two-loop recursion (Nocedal & Wright, Algorithm 7.4)."""
        q, shares = force.copy(), []
        for step, change, curvature in reversed(pairs):
            share = float(np.vdot(step, q)) / curvature
            add_scaled(q, -share, change)
            shares.append(share)
        direction = self._laplacian.cycle(q)
        if pairs:
            step, change, curvature = pairs[-1]
            direction *= curvature / float(np.vdot(change, self._laplacian.cycle(change)))
        for (step, change, curvature), share in zip(pairs, reversed(shares), strict=True):
            add_scaled(direction, share - float(np.vdot(change, direction)) / curvature, step)
        return np.negative(direction, out=direction)


@compiled
def add_scaled(target: Array, factor: float, values: Array) -> None:
    """Add ``factor`` times ``values`` (n, 3) to ``target`` (n, 3) in place, without a new array."""
    for i in range(target.shape[0]):
        for d in range(3):
            target[i, d] += factor * values[i, d]


# The three neighbours of every corner of a hexahedron, right-handed.
_NEIGHBOURS = np.array(
    [(0, 1, 3, 4), (1, 2, 0, 5), (2, 3, 1, 6), (3, 0, 2, 7),
     (4, 7, 5, 0), (5, 4, 6, 1), (6, 5, 7, 2), (7, 6, 4, 3)]
)  # fmt: skip
