"""What a fit takes of a run: how the tank was accelerated, and the force and moment it met."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from coupling.motion.shaking import motion_of
from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.results import open_results


@dataclass(frozen=True, kw_only=True)
class Recording:
    """A run from rest at even instants, time 0 the first; n of them, ``step`` [s] apart.

    ``acceleration`` (n,) [m/s^2] of the tank along its direction; ``force`` (n,) [N] of the liquid
    along it; ``moment`` (n,) [N m] about the tank's centre and the axis that is upwards times the
    direction: a force at a height z over the centre has the moment z times the force.
    """

    name: str
    step: float
    acceleration: Array
    force: Array
    moment: Array


def directions(scene: Scene) -> tuple[Array, Array]:
    """The direction of shaking and the axis of the moment, (3,) each, of length 1."""
    along = scene.motion.unit_direction
    upwards = -np.array(scene.gravity) / np.linalg.norm(scene.gravity)
    return along, np.asarray(np.cross(upwards, along), dtype=np.float64)


def recording_of(name: str, scene: Scene, folder: Path) -> Recording:
    """Read the run of ``scene`` in ``folder``; steps that were taken in parts are passed over.

    Force and moment at rest are subtracted. Raises ``UnreadableFile``.
    """
    steps = open_results(folder).steps
    along, axis = directions(scene)
    step = scene.time.step
    time = step * np.arange(scene.time.steps + 1)
    motion = motion_of(scene)
    force, moment = steps.force @ along, steps.moment @ axis
    return Recording(
        name=name,
        step=step,
        acceleration=np.array([motion.acceleration(t) for t in time]) @ along,
        force=np.interp(time, steps.time, force - force[0]),
        moment=np.interp(time, steps.time, moment - moment[0]),
    )
