"""Bending about the moulded, curved shape: one quadratic energy per hinge.

Bergou et al., "A quadratic bending model for inextensible surfaces" (2006), for the operator;
the curved rest state enters through a signed hinge normal, so that the mirrored shape costs energy.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp

from cloth.arrays import Array, Ints
from cloth.mesh import Mesh, interior_edges


@dataclass(frozen=True, kw_only=True)
class Hinges:
    """E = 1/2 sum_h weight_h |sum_i coefficient_hi x_i - curvature_h normal_h|^2.

    ``nodes`` (e, 4): edge start and end, the two opposite nodes; ``coefficients`` (e, 4) [-];
    ``weight`` (e,) [N/m]; ``curvature`` (e,) [m], the moulded length of the sum along the normal.
    """

    nodes: Ints
    coefficients: Array
    weight: Array
    curvature: Array


def _cotangent(a: Array, b: Array) -> Array:
    dot = np.einsum("ij,ij->i", a, b)
    return np.asarray(dot / np.linalg.norm(np.cross(a, b), axis=1))


def hinge_normals(points: Array, nodes: Ints) -> Array:
    """Unit mean normals (e, 3) of the two triangles at every hinge, towards the gas."""
    x = points[nodes]
    n1 = np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    n2 = np.cross(x[:, 3] - x[:, 0], x[:, 1] - x[:, 0])
    n1 = n1 / np.linalg.norm(n1, axis=1)[:, None]
    n2 = n2 / np.linalg.norm(n2, axis=1)[:, None]
    total = n1 + n2
    return np.asarray(total / np.maximum(np.linalg.norm(total, axis=1), 1e-12)[:, None])


def build_hinges(mesh: Mesh, stiffness: float) -> Hinges:
    """Hinges of ``mesh`` for a bending ``stiffness`` kappa [N m], at rest when moulded.

    The weight 3 / area makes a sphere's energy 2 kappa / r^2 per area. Bending in one direction
    then costs three times kappa / (2 r^2) (Seung and Nelson 1988 for equilateral triangles;
    measured on right-angled ones too): wrinkles are stiffer than the plate's.
    """
    nodes = interior_edges(mesh.triangles)
    x = mesh.points[nodes]
    e0, e1, e2 = x[:, 1] - x[:, 0], x[:, 2] - x[:, 0], x[:, 3] - x[:, 0]
    e3, e4 = x[:, 2] - x[:, 1], x[:, 3] - x[:, 1]
    c01, c02 = _cotangent(e0, e1), _cotangent(e0, e2)
    c03, c04 = _cotangent(-e0, e3), _cotangent(-e0, e4)
    coefficients = np.stack([c03 + c04, c01 + c02, -c01 - c03, -c02 - c04], axis=1)
    area = 0.5 * (
        np.linalg.norm(np.cross(e0, e1), axis=1) + np.linalg.norm(np.cross(e0, e2), axis=1)
    )
    sums = np.einsum("ei,eid->ed", coefficients, x)
    curvature = np.einsum("ed,ed->e", sums, hinge_normals(mesh.points, nodes))
    return Hinges(
        nodes=nodes,
        coefficients=coefficients,
        weight=3.0 * stiffness / area,
        curvature=np.asarray(curvature),
    )


def bending_matrix(hinges: Hinges, size: int) -> sp.csc_matrix:
    """Q (n, n) [N/m]: the constant Hessian of the bending energy, the same for x, y and z."""
    c, nodes = hinges.coefficients, hinges.nodes
    blocks = hinges.weight[:, None, None] * c[:, :, None] * c[:, None, :]
    rows = np.repeat(nodes[:, :, None], 4, axis=2)
    columns = np.repeat(nodes[:, None, :], 4, axis=1)
    return sp.csc_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size))
