"""Rotation matrices and vectors."""

from __future__ import annotations

import numpy as np

from cloth.arrays import Array


def rotation_matrix(vector: Array) -> Array:
    """Return the matrix (3, 3) of a rotation ``vector`` (3,) [rad]."""
    from scipy.spatial.transform import Rotation  # takes long to import, and few steps need it

    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def cross_matrix(vector: Array) -> Array:
    """Return the matrix (3, 3) of the cross product by a ``vector`` (3,)."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def axial(matrix: Array) -> Array:
    """Return the sum of x x y (3,) of vectors whose sum of y x^T is the ``matrix`` (3, 3)."""
    m = matrix
    return np.array([m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]])
