"""Bending about the moulded, curved shape: Koiter's energy, quadratic in the positions.

Per area, kappa/2 [(1 - nu) |rho|^2 + nu (tr rho)^2], rho = b - b0 the change of curvature from the
moulded b0 (Koiter, "On the nonlinear theory of thin elastic shells", 1966; a flat plate's where b0
is 0). With T = b11 + b22, D = b11 - b22 and S = 2 b12, and T0, D0, S0 as moulded, that is

    kappa/2 [(1 + nu)/2 (T - T0)^2 + (1 - nu)/2 ((D - D0)^2 + (S - S0)^2)].

The moulded state enters through a signed normal, so that the mirrored shape costs energy: 8 pi
(1 + nu) kappa for a hemisphere. To resist the mean curvature alone, kappa/2 (T - T0)^2, differs by
the integral of det rho, which the border fixes for a flat plate (Gauss and Bonnet), but not for a
curved shape: the mirrored hemisphere would cost 16 pi kappa, whatever nu.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from cloth.arrays import Array, Bools, Ints
from cloth.curvature import curvature_of, neighbours, voronoi_areas
from cloth.mesh import Mesh, border_nodes


@dataclass(frozen=True, kw_only=True)
class Bending:
    """A bending energy that is quadratic in the positions but for its normals, and 0 as moulded.

    E = x.Q x/2 - x.held - sum_i moment_i n_i.(R x)_i, and a constant that makes it 0 as moulded.
    ``matrix`` Q (n, n) [N/m], the same for x, y and z. R [1/m^3] stands in rows: ``starts``
    (n + 1,), ``columns`` and ``values``; n.(R x) is the product of the curvature with the moulded
    moment over kappa, nu tr(b0) I + (1 - nu) b0. ``moment`` (n,) [N m^3]: kappa times the area that
    a node stands for. ``held`` (n, 3) [N]: of a clamped rim.
    """

    matrix: sp.csc_matrix
    starts: Ints
    columns: Ints
    values: Array
    moment: Array
    held: Array

    def energy(self, position: Array, normals: Array) -> float:
        """Return the energy E [J], without the constant that makes it 0 as moulded.

        Parameters
        ----------
        position
            Positions (n, 3) [m].
        normals
            Unit normals of the sheet there (n, 3), 0 of nodes without one.
        """
        moulded = np.einsum("id,id->i", np.asarray(self._rows @ position), normals)
        quadratic = 0.5 * float(np.vdot(position, self.matrix @ position))
        return quadratic - float(self.moment @ moulded) - float(np.vdot(position, self.held))

    @cached_property
    def _rows(self) -> sp.csr_matrix:
        """R (n, n) [1/m^3]."""
        return sp.csr_matrix((self.values, self.columns, self.starts), shape=self.matrix.shape)


def carried_areas(mesh: Mesh, rim: Bools) -> Array:
    """Return the nodes' areas (n,) [m^2], those of the border shared among neighbours off it.

    They are ``voronoi_areas`` otherwise, and nodes of the ``rim`` (n,) keep theirs. Curvature is
    known off the border: without the border's half cells a plate on a simple support is too soft by
    their share, of first order in the grid; with them, at their neighbours' curvature, the error is
    of second order.
    """
    areas, pairs = voronoi_areas(mesh), neighbours(mesh.triangles)
    border = np.zeros(len(areas), dtype=bool)
    border[border_nodes(mesh.triangles)] = True
    given = border & ~rim
    pairs = pairs[given[pairs[:, 0]] & ~border[pairs[:, 1]]]
    takers = np.maximum(np.bincount(pairs[:, 0], minlength=len(areas)), 1)
    share = (areas / takers)[pairs[:, 0]]
    more = np.bincount(pairs[:, 1], weights=share, minlength=len(areas))
    return np.where(given, 0.0, areas + more)


def bending_of(mesh: Mesh, stiffness: Array, poisson: float, *, clamped: bool = False) -> Bending:
    """Return the bending of ``mesh`` with kappa = ``stiffness`` (n,) [N m], at rest as moulded.

    ``poisson`` [-]. The border is free to turn: free edges, and simple supports where nodes are
    fixed. ``clamped``: the fixed nodes of the border hold the moulded slope, as if the moulded
    shape went on beyond them; they must be held where they were moulded. A slope held along a fixed
    rim leaves one component of rho, across the rim, of which the border's row of the Laplacian
    L gives area times rho = -L (x - X0): kappa/2 rho^2 per area, quadratic as the rest is.
    """
    rim = np.zeros(len(mesh.points), dtype=bool)
    rim[border_nodes(mesh.triangles)] = clamped
    rim &= mesh.fixed
    known, area = curvature_of(mesh), carried_areas(mesh, rim)
    even, uneven = 0.5 * (1.0 + poisson), 0.5 * (1.0 - poisson)
    terms = ((even, known.trace), (uneven, known.difference), (uneven, known.twist))
    moment = np.where(rim, 0.0, stiffness * area)
    matrix = moulded = sp.csr_matrix(known.trace.shape)
    for factor, rows in terms:
        curvature = np.einsum("id,id->i", rows @ mesh.points, known.normals)
        matrix = matrix + factor * (rows.T @ sp.diags(moment) @ rows)
        moulded = sp.csr_matrix(moulded + sp.diags(factor * curvature) @ rows)
    at_rim = np.where(rim, stiffness / np.where(rim, area, 1.0), 0.0)
    beside = known.laplacian.T @ sp.diags(at_rim) @ known.laplacian
    return Bending(
        matrix=sp.csc_matrix(matrix + beside),
        starts=moulded.indptr.astype(np.int64),
        columns=moulded.indices.astype(np.int64),
        values=np.ascontiguousarray(moulded.data),
        moment=moment,
        held=np.asarray(beside @ mesh.points),
    )
