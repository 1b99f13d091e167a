"""How fast and how hard a scene's tank is shaken: what is known of its motion before a run."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array
from coupling.scene.scene import Scene


def driving_frequency(scene: Scene) -> float:
    """[Hz] of a sine; of a table its ``characteristic_frequency``; 0 at rest."""
    motion = scene.motion
    if motion.kind == "sine":
        return float(motion.frequency or 0.0)
    if motion.kind == "table":
        return motion.record.characteristic_frequency
    return 0.0


def peak_accelerations(scene: Scene) -> Array:
    """Accelerations (k, 3) [m/s^2] of the tank among which the largest are.

    ``sine``: A (2 pi f)^2 either way along its direction; what the smooth start adds is left out.
    ``table``: all of its lines, within the run or not.
    """
    motion = scene.motion
    if motion.kind == "sine" and motion.amplitude and motion.frequency:
        peak = motion.amplitude * (2.0 * np.pi * motion.frequency) ** 2
        return np.outer([peak, -peak], motion.unit_direction)
    if motion.kind == "table":
        return motion.record.acceleration
    return np.zeros((1, 3))


def largest_body_force(scene: Scene) -> float:
    """Largest |g - a| [m/s^2] of the motion, a the tank's acceleration (``peak_accelerations``)."""
    return _largest(np.array(scene.gravity) - peak_accelerations(scene))


def largest_acceleration(scene: Scene) -> float:
    """Largest |a| [m/s^2] of the tank (``peak_accelerations``)."""
    return _largest(peak_accelerations(scene))


def _largest(vectors: Array) -> float:
    """Largest length of ``vectors`` (k, 3), ten times as fast as ``norm`` where k is large."""
    return float(np.sqrt(np.einsum("kx,kx->k", vectors, vectors).max()))
