"""The definition of ``Eliminated.matrix``, by products of sparse matrices."""

import numpy as np
from scipy.sparse import coo_array, csc_array


def laplacian(mesh, geometry):
    """Outward flux of -grad p (c, c) of every cell: ``Gauss linear corrected``, over-relaxed."""
    inner = mesh.inner_faces
    owner, neighbour = mesh.owner[:inner], mesh.neighbour
    area = geometry.face_area[:inner]
    reach = geometry.centre[neighbour] - geometry.centre[owner]
    size = np.linalg.norm(area, axis=1)
    along = np.einsum("fx,fx->f", area, reach) / size
    along = np.maximum(along, 0.05 * np.linalg.norm(reach, axis=1))  # bounded as in OpenFOAM
    faces, shape = np.arange(inner), (inner, mesh.cells)
    difference = _sparse(faces, neighbour, 1.0, shape) - _sparse(faces, owner, 1.0, shape)
    to_owner = np.einsum("fx,fx->f", geometry.face_centre[:inner] - geometry.centre[owner], area)
    to_neighbour = np.einsum(
        "fx,fx->f", geometry.centre[neighbour] - geometry.face_centre[:inner], area
    )
    weight = np.abs(to_neighbour) / (np.abs(to_owner) + np.abs(to_neighbour))
    mean = _sparse(faces, owner, weight, shape) + _sparse(faces, neighbour, 1 - weight, shape)
    flux = csc_array(difference.multiply((size / along)[:, None]))
    boundary = _sparse(np.arange(len(mesh.owner) - inner), mesh.owner[inner:], 1.0,
                       (len(mesh.owner) - inner, mesh.cells))  # fmt: skip
    for axis in range(3):
        outward = difference.T.multiply(-area[:, axis]) @ mean
        outward += boundary.T.multiply(geometry.face_area[inner:, axis]) @ boundary
        gradient = outward.multiply((1 / geometry.volume)[:, None])
        slant = area[:, axis] - (size / along) * reach[:, axis]
        flux = flux + (mean @ gradient).multiply(slant[:, None])
    return csc_array(difference.T @ flux)


def _sparse(rows, columns, values, shape):
    data = np.broadcast_to(np.asarray(values, dtype=float), rows.shape)
    return csc_array(coo_array((data, (rows, columns)), shape=shape))
