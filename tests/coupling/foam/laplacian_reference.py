"""Definitions of ``Eliminated.matrix`` and of the pressure beside an accelerating wall."""

import numpy as np
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import spsolve


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


def pressure_beside_walls(mesh, geometry, rate):
    """p/rho (c,) as OpenFOAM finds it: the non-orthogonal fluxes lag, until they change no more."""
    inner, count = mesh.inner_faces, mesh.diaphragm_faces
    owner, neighbour, wall = mesh.owner[:inner], mesh.neighbour, mesh.owner[inner:]
    area, edge = geometry.face_area[:inner], geometry.face_area[inner:]
    reach = geometry.centre[neighbour] - geometry.centre[owner]
    stiff = np.sum(area**2, axis=1) / np.sum(area * reach, axis=1)
    sides = [
        np.abs(np.sum((geometry.face_centre[:inner] - geometry.centre[side]) * area, axis=1))
        for side in (owner, neighbour)
    ]
    weight = (sides[1] / (sides[0] + sides[1]))[:, None]
    normal = edge / np.linalg.norm(edge, axis=1)[:, None]
    half = np.sum((geometry.face_centre[inner:] - geometry.centre[wall]) * normal, axis=1)
    beyond = np.where(np.arange(len(wall)) < count, -half * rate / np.linalg.norm(edge, axis=1), 0)
    ends = np.concatenate([owner, neighbour]), np.concatenate([neighbour, owner])
    shape = mesh.cells, mesh.cells
    matrix = _sparse(ends[0], ends[0], np.tile(stiff, 2), shape)
    matrix = csc_array(matrix - _sparse(*ends, np.tile(stiff, 2), shape))[1:, 1:]
    pressure = np.zeros(mesh.cells)
    for _ in range(60):
        on_face = weight[:, 0] * pressure[owner] + (1 - weight[:, 0]) * pressure[neighbour]
        gradient = np.zeros((mesh.cells, 3))
        np.add.at(gradient, owner, on_face[:, None] * area)
        np.subtract.at(gradient, neighbour, on_face[:, None] * area)
        np.add.at(gradient, wall, (pressure[wall] + beyond)[:, None] * edge)
        gradient /= geometry.volume[:, None]
        mean = weight * gradient[owner] + (1 - weight) * gradient[neighbour]
        lagged = np.sum((area - stiff[:, None] * reach) * mean, axis=1)
        source = np.bincount(wall, -rate, mesh.cells)
        np.add.at(source, owner, lagged)
        np.subtract.at(source, neighbour, lagged)
        pressure[1:] = spsolve(matrix, source[1:])
    return pressure


def _sparse(rows, columns, values, shape):
    data = np.broadcast_to(np.asarray(values, dtype=float), rows.shape)
    return csc_array(coo_array((data, (rows, columns)), shape=shape))
