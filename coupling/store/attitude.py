"""Vectors of a run between the tank's axes and those that do not turn."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from coupling.ports import Array


class Shaken(Protocol):
    """What is known of a tank's motion at T instants."""

    @property
    def tank_acceleration(self) -> Array:
        """(T, 3) [m/s^2], in axes that do not turn."""

    @property
    def tank_rotation(self) -> Array:
        """Rotation vectors (T, 3) [rad] from the tank's axes to those that do not turn."""


def rotation_vector(attitude: Array) -> Array:
    """Return the rotation vector (3,) [rad] of an ``attitude`` (3, 3); its size is at most pi."""
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_matrix(attitude).as_rotvec())


def in_ground(vectors: Array, run: Shaken) -> Array:
    """Return ``vectors`` (T, 3), given in the tank's axes, in those that do not turn."""
    return _turned(vectors, run, inverse=False)


def in_tank(vectors: Array, run: Shaken) -> Array:
    """Return ``vectors`` (T, 3), given in axes that do not turn, in the tank's."""
    return _turned(vectors, run, inverse=True)


def body_force(gravity: Array, run: Shaken) -> Array:
    """Return g - a (T, 3) [m/s^2] in the tank's axes; ``gravity`` (3,) is in those that stay."""
    return in_tank(gravity - run.tank_acceleration, run)


def _turned(vectors: Array, run: Shaken, *, inverse: bool) -> Array:
    if not np.any(run.tank_rotation):
        return vectors
    from scipy.spatial.transform import Rotation

    return np.asarray(Rotation.from_rotvec(run.tank_rotation).apply(vectors, inverse=inverse))
