"""Rotation matrices and vectors, compiled: a step of a free tank asks for many."""

from __future__ import annotations

import math

import numpy as np

from cloth.arrays import Array
from cloth.compiled import compiled


@compiled
def rotation_matrix(vector: Array) -> Array:
    """Return the matrix (3, 3) of a rotation ``vector`` (3,) [rad], by Rodrigues' formula."""
    x, y, z = vector[0], vector[1], vector[2]
    angle = math.sqrt(x * x + y * y + z * z)
    first, half = 1.0, 1.0  # sin(a)/a, and 2 (1 - cos a)/a^2 by its root
    if angle > 0.0:
        first = math.sin(angle) / angle
        half = math.sin(0.5 * angle) / (0.5 * angle)
    second = 0.5 * half * half
    matrix = np.empty((3, 3))
    matrix[0, 0] = 1.0 - second * (y * y + z * z)
    matrix[1, 1] = 1.0 - second * (z * z + x * x)
    matrix[2, 2] = 1.0 - second * (x * x + y * y)
    matrix[0, 1], matrix[1, 0] = second * x * y - first * z, second * x * y + first * z
    matrix[0, 2], matrix[2, 0] = second * x * z + first * y, second * x * z - first * y
    matrix[1, 2], matrix[2, 1] = second * y * z - first * x, second * y * z + first * x
    return matrix


@compiled
def cross_matrix(vector: Array) -> Array:
    """Return the matrix (3, 3) of the cross product by a ``vector`` (3,)."""
    matrix = np.zeros((3, 3))
    matrix[0, 1], matrix[0, 2] = -vector[2], vector[1]
    matrix[1, 0], matrix[1, 2] = vector[2], -vector[0]
    matrix[2, 0], matrix[2, 1] = -vector[1], vector[0]
    return matrix


@compiled
def axial(matrix: Array) -> Array:
    """Return the sum of x x y (3,) of vectors whose sum of y x^T is the ``matrix`` (3, 3)."""
    found = np.empty(3)
    found[0] = matrix[2, 1] - matrix[1, 2]
    found[1] = matrix[0, 2] - matrix[2, 0]
    found[2] = matrix[1, 0] - matrix[0, 1]
    return found
