"""How fast and how hard a scene's tank is shaken: what is known of its motion before a run."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from coupling.motion_table import read_motion_table
from coupling.ports import Array
from coupling.scene import Scene

POWER = 0.9  # of a table's acceleration: the share that lies below its characteristic frequency


def driving_frequency(scene: Scene) -> float:
    """[Hz] of a sine; of a table its ``characteristic_frequency``; 0 at rest.

    ``TableError`` if the table has changed since the scene was read and is now wrong.
    """
    motion = scene.motion
    if motion.kind == "sine":
        return float(motion.frequency or 0.0)
    if motion.kind == "table" and motion.file:
        table = read_motion_table(Path(motion.file))
        return characteristic_frequency(table.time, table.acceleration)
    return 0.0


def characteristic_frequency(time: Array, acceleration: Array) -> float:
    """Frequency [Hz] below which POWER of the acceleration's energy lies, its mean left out.

    ``time`` (T,) [s], ``acceleration`` (T, 3) [m/s^2], linear in between. Resolved to one over the
    table's length. 0 where nothing changes.
    """
    if len(time) < 2:
        return 0.0
    even = np.linspace(time[0], time[-1], max(4 * len(time), 64), endpoint=False)
    signal = np.stack([np.interp(even, time, part) for part in acceleration.T], axis=1)
    spectrum = np.abs(np.fft.rfft(signal - signal.mean(axis=0), axis=0)) ** 2
    energy = np.cumsum(spectrum.sum(axis=1))
    if energy[-1] <= 0.0:
        return 0.0
    frequencies = np.fft.rfftfreq(len(even), even[1] - even[0])
    return float(frequencies[np.searchsorted(energy, POWER * energy[-1])])


def peak_accelerations(scene: Scene) -> Array:
    """Accelerations (k, 3) [m/s^2] of the tank among which the largest are.

    ``sine``: A (2 pi f)^2 either way along its direction; what the smooth start adds is left out.
    ``table``: all of its lines, within the run or not. ``TableError`` as ``driving_frequency``.
    """
    motion = scene.motion
    if motion.kind == "sine" and motion.amplitude and motion.frequency:
        peak = motion.amplitude * (2.0 * np.pi * motion.frequency) ** 2
        return np.outer([peak, -peak], motion.unit_direction)
    if motion.kind == "table" and motion.file:
        return read_motion_table(Path(motion.file)).acceleration
    return np.zeros((1, 3))


def largest_body_force(scene: Scene) -> float:
    """Largest |g - a| [m/s^2] of the motion, a the tank's acceleration (``peak_accelerations``)."""
    return float(np.linalg.norm(np.array(scene.gravity) - peak_accelerations(scene), axis=1).max())
