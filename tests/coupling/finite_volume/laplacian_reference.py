"""Definitions of ``Eliminated.matrix`` and of the pressure on and beside an accelerating wall."""

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
    within = [  # gradients without what the walls' faces add
        (difference.T.multiply(-area[:, axis]) @ mean).multiply((1 / geometry.volume)[:, None])
        for axis in range(3)
    ]
    to_face = aside(mesh, geometry)
    walls = boundary + sum(
        (boundary @ within[axis]).multiply(to_face[:, axis][:, None]) for axis in range(3)
    )
    for axis in range(3):
        outward = boundary.T.multiply(geometry.face_area[inner:, axis]) @ walls
        gradient = within[axis] + outward.multiply((1 / geometry.volume)[:, None])
        slant = area[:, axis] - (size / along) * reach[:, axis]
        flux = flux + (mean @ gradient).multiply(slant[:, None])
    return csc_array(difference.T @ flux)


def aside(mesh, geometry):
    """From cells' centres to their faces on walls (B, 3), along these and no further than across.

    Zero where a cell has two walls.
    """
    own, edge = mesh.owner[mesh.inner_faces :], geometry.face_area[mesh.inner_faces :]
    normal = edge / np.linalg.norm(edge, axis=1)[:, None]
    reach = geometry.face_centre[mesh.inner_faces :] - geometry.centre[own]
    across = np.sum(reach * normal, axis=1)[:, None]
    along = reach - across * normal
    longest = np.maximum(np.linalg.norm(along, axis=1)[:, None], 1e-300)
    alone = np.bincount(own, minlength=mesh.cells)[own] == 1
    return np.where(alone[:, None], along * np.minimum(1.0, np.abs(across) / longest), 0.0)


def on_walls(mesh, geometry, values):
    """``values`` (c,) of the cells carried on to their faces on walls (B,), along these alone."""
    inner, own = mesh.inner_faces, mesh.owner[mesh.inner_faces :]
    owner, neighbour, area = mesh.owner[:inner], mesh.neighbour, geometry.face_area[:inner]
    near, far = (
        np.abs(np.sum((geometry.face_centre[:inner] - geometry.centre[side]) * area, axis=1))
        for side in (owner, neighbour)
    )
    flow = ((far * values[owner] + near * values[neighbour]) / (near + far))[:, None] * area
    gradient = np.zeros((mesh.cells, 3))
    np.add.at(gradient, owner, flow)
    np.subtract.at(gradient, neighbour, flow)
    along = np.sum(aside(mesh, geometry) * gradient[own], axis=1) / geometry.volume[own]
    return values[own] + along


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
        on_wall = on_walls(mesh, geometry, pressure) + beyond
        np.add.at(gradient, wall, on_wall[:, None] * edge)
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
