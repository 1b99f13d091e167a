"""How fast and how hard a scene's tank is shaken: what is known of its motion before a run."""

from __future__ import annotations

import numpy as np

from coupling.motion import MOTIONS
from coupling.motion.kind import Attitude, TankMotion
from coupling.ports import Array
from coupling.scene.scene import Scene


def motion_of(scene: Scene) -> TankMotion:
    """The tank's motion that a scene describes."""
    return MOTIONS[scene.motion.kind].motion(scene.motion)


def attitude_of(scene: Scene) -> Attitude | None:
    """How a scene's tank turns; None where it does not."""
    return MOTIONS[scene.motion.kind].attitude(scene.motion)


def driving_frequency(scene: Scene) -> float:
    """[Hz] of a periodic motion; of a table its ``characteristic_frequency``; 0 at rest."""
    return MOTIONS[scene.motion.kind].characteristic_frequency(scene.motion)


def moves(scene: Scene) -> bool:
    """Whether the tank moves at all."""
    return MOTIONS[scene.motion.kind].moves


def peak_accelerations(scene: Scene) -> Array:
    """Accelerations (k, 3) [m/s^2] of the tank among which the largest are.

    Of a tank that turns those which one that does not would need for the same body force in its
    own axes: a tilt is one too.
    """
    kind, turning = MOTIONS[scene.motion.kind], attitude_of(scene)
    if turning is None:
        return kind.peak_accelerations(scene.motion)
    motion, gravity = kind.motion(scene.motion), np.array(scene.gravity)
    body = [
        (gravity - motion.acceleration(time)) @ turning.matrix(time)
        for time in kind.instants(scene.motion)
    ]
    return gravity - np.array(body)


def largest_body_force(scene: Scene) -> float:
    """Largest |g - a| [m/s^2] of the motion, a the tank's acceleration (``peak_accelerations``)."""
    return _largest(np.array(scene.gravity) - peak_accelerations(scene))


def largest_acceleration(scene: Scene) -> float:
    """Largest |a| [m/s^2] of the tank (``peak_accelerations``)."""
    return _largest(peak_accelerations(scene))


def _largest(vectors: Array) -> float:
    """Largest length of ``vectors`` (k, 3), ten times as fast as ``norm`` where k is large."""
    return float(np.sqrt(np.einsum("kx,kx->k", vectors, vectors).max()))
