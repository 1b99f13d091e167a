"""The same material points of two meshes of one moulded diaphragm."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from coupling.ports import Array, Ints

_CANDIDATES = 24  # triangles with the nearest centroids; the one that is met is among them
_EDGE_ON = 1e-9  # of three radii's product: a corner of the thesis' square lies in the rim's plane


def material_interpolation(moulded: Array, triangles: Ints, places: Array) -> csr_array:
    """Return the matrix that takes nodal values of one mesh to the moulded points of another.

    Parameters
    ----------
    moulded
        Moulded nodes (n, 3) [m] of a sheet that rays from the origin meet once, up to its rim.
    triangles
        Nodes of each triangle (m, 3).
    places
        Points (k, 3) [m] of the same moulded shape, none at the origin.

    Returns
    -------
    csr_array
        Sparse matrix (k, n) [-] with three entries a row, which sum to 1.

    Notes
    -----
    Either mesh may be moulded above the rim or below it, as the thesis' grid is: a material
    point is given by its azimuth and its angle from the pole.

    Linear in the triangle that the ray from the origin through the point meets, which is exact for
    fields linear in space along the facets. Of a smooth field it misses |field''| h^2/8 at the
    most, h the longest edge: of the moulded shape itself h^2/(8 R), 0.12 % of R with 16 rings.
    Among the 24 triangles with the nearest centroids the one that fits the ray best is taken;
    whether the ray meets it is not checked.
    """
    corners = _above(moulded)[triangles]
    seen = np.abs(np.linalg.det(corners)) > _EDGE_ON * np.linalg.norm(corners, axis=2).prod(axis=1)
    corners, triangles = corners[seen], triangles[seen]
    directions = _above(places)
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    centres = corners.mean(axis=1)
    centres /= np.linalg.norm(centres, axis=1)[:, None]
    near = cKDTree(centres).query(directions, k=min(_CANDIDATES, len(triangles)))[1]
    near = near.reshape(len(places), -1)
    inverse = np.linalg.inv(corners.transpose(0, 2, 1))
    shares = np.einsum("kcij,kj->kci", inverse[near], directions)
    shares /= shares.sum(axis=2, keepdims=True)
    met = np.argmax(shares.min(axis=2), axis=1)
    rows = np.arange(len(places))
    weights, chosen = shares[rows, met], near[rows, met]
    return csr_array(
        (weights.ravel(), (np.repeat(rows, 3), triangles[chosen].ravel())),
        shape=(len(places), len(moulded)),
    )


def _above(points: Array) -> Array:
    return np.column_stack([points[:, :2], np.abs(points[:, 2])])
