"""How a free tank moved, what held it, and where its energy went."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.step_series import StepSeries


def by_axis(steps: StepSeries, name: str) -> Array:
    """The metric ``name`` of every step by component (T, 3), in its unit."""
    return np.stack([steps.metrics[f"{name}_{axis}"] for axis in "xyz"], axis=-1)


def carrier_rest(steps: StepSeries) -> Array:
    """What the energy of the tank leaves (T,) [J]: the time step's, 0 where it loses none.

    Work of the ground and of the given force, less what the dampers took and what went to the
    contents, less what is stored in springs and motion.
    """
    metrics = steps.metrics
    stored = metrics["carrier_kinetic_energy"] + metrics["spring_energy"]
    return np.asarray(
        metrics["carrier_work"] - metrics["damper_loss"] - metrics["contents_work"] - stored
    )


def carrier_summary(steps: StepSeries, scene: Scene) -> dict[str, Any] | None:
    """Largest motions and forces of a free tank by axis, momentum and energies [J] at the end.

    ``mass_kg`` of the tank alone; ``momentum_kg_m_s`` of tank and contents. ``contents_work_J``:
    work on liquid and diaphragm in the tank's frame; ``rest_J``: see ``carrier_rest``. The largest
    rotation vector and moment of what holds it against turning are None of a tank that cannot. All
    is None of a tank whose motion is prescribed.
    """
    if not scene.carrier.free or "momentum_x" not in steps.metrics or not len(steps.time):
        return None
    metrics, turns = steps.metrics, scene.carrier.inertia is not None
    return {
        "mass_kg": scene.carrier.mass,
        "displacement_max_m": np.abs(steps.tank_displacement).max(axis=0),
        "acceleration_max_m_s2": np.abs(steps.tank_acceleration).max(axis=0),
        "support_force_max_N": np.abs(by_axis(steps, "support_force")).max(axis=0),
        "rotation_max_deg": np.degrees(np.abs(steps.tank_rotation).max(axis=0)) if turns else None,
        "support_moment_max_N_m": np.abs(by_axis(steps, "support_moment")).max(axis=0)
        if turns
        else None,
        "momentum_kg_m_s": by_axis(steps, "momentum")[-1],
        "work_J": metrics["carrier_work"][-1],
        "damper_loss_J": metrics["damper_loss"][-1],
        "contents_work_J": metrics["contents_work"][-1],
        "kinetic_energy_J": metrics["carrier_kinetic_energy"][-1],
        "spring_energy_J": metrics["spring_energy"][-1],
        "rest_J": carrier_rest(steps)[-1],
    }
