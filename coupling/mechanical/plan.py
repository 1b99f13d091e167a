"""Which runs identify a tank: for every fill and amplitude two sweeps, and three runs to check."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.campaign.sweep_plan import POINTS
from coupling.estimate.numbers import numbers_of
from coupling.fluids import FLUIDS
from coupling.mechanical.apparent_mass import Band
from coupling.mechanical.excitation import HIGH, LOW, STEPS_A_PERIOD, random_record, sweep
from coupling.motion import MOTIONS
from coupling.ports import Array
from coupling.scene.scene import Scene, SceneError, load_scene, with_overrides
from coupling.store.atomic import write_text

RECORDS = "records"  # folder of the tables that shake the tank
CHECK_SINES = (0.7, 1.3)  # over f1
CHECK_RAMP, CHECK_PERIODS = 2.0, 8.0  # periods of those sines
_BELOW = 0.5  # of a sweep's lowest frequency: where the band that is fitted begins


@dataclass(frozen=True, kw_only=True)
class Planned:
    """A run: ``fits`` if the model is identified by it, else the model is held against it.

    ``place``: its folder within that of the identification; ``says``: its motion in words.
    """

    name: str
    says: str
    fits: bool
    scene: Scene
    place: Path


@dataclass(frozen=True, kw_only=True)
class Condition:
    """One fill and amplitude: what is identified together.

    ``slosh`` [Hz]: first slosh frequency by formula, which times and frequencies go by.
    """

    name: str
    fill_fraction: float
    amplitude: float
    scene: Scene
    slosh: float
    runs: tuple[Planned, ...] = ()

    @property
    def band(self) -> Band:
        """Frequencies that are fitted: from below a sweep's lowest to its highest."""
        return Band(low=_BELOW * LOW * self.slosh, high=HIGH * self.slosh)

    @property
    def mass(self) -> float:
        """Mass of the liquid [kg]."""
        return self.scene.liquid.density * self.scene.liquid_volume


def conditions(
    scene_path: Path, changes: Sequence[str], fills: Sequence[float], amplitudes: Sequence[float]
) -> list[Condition]:
    """Every fill with every amplitude, checked; without their runs. Nothing is written.

    Raises ``SceneError``.
    """
    problems = [
        f"{option}: must be given, each value once, all above 0, got {list(values)}. "
        f"Give {mend}, separated by commas."
        for option, values, mend in (
            ("--fill", fills, "fill fractions below 1"),
            ("--amplitude", amplitudes, "amplitudes of the tank's sway in metres"),
        )
        if not values or len(set(values)) < len(values) or not min(values) > 0.0
    ]
    if problems:
        raise SceneError(problems)
    found = []
    for fill in fills:
        scene = _identifiable(load_scene(scene_path, [*changes, f"liquid.fill_fraction={fill}"]))
        slosh = numbers_of(scene).slosh_frequency
        found += [
            Condition(
                name=f"fill_{fill:g}__amplitude_{amplitude:g}",
                fill_fraction=fill,
                amplitude=amplitude,
                scene=scene,
                slosh=slosh,
            )
            for amplitude in amplitudes
        ]
    return found


def _identifiable(scene: Scene) -> Scene:
    """The scene with a liquid that has waves; ``SceneError`` where it has none."""
    waves = [name for name in FLUIDS if FLUIDS[name].has_flow]
    if "fluid" not in scene.model.model_fields_set:
        scene = with_overrides(scene, {"model.fluid": waves[0]})
    fluid = scene.model.fluid
    if fluid not in waves:
        raise SceneError(
            [
                f'model.fluid: must be {" or ".join(waves)} to identify a tank, got "{fluid}". '
                "Any other liquid has no waves, or is chosen run by run."
            ]
        )
    if scene.carrier.free:
        raise SceneError(
            [
                'carrier.kind: must be "prescribed" to identify a tank, got "free". Leave '
                "[carrier] out: the liquid's model does not depend on what carries the tank."
            ]
        )
    if MOTIONS[scene.motion.kind].turns(scene.motion):
        raise SceneError(
            [
                "motion: a tank that turns is not identified: its pendulums are those of sway. "
                "Leave the rotation out, such as with --set motion.kind=rest."
            ]
        )
    along, gravity = scene.motion.unit_direction, np.array(scene.gravity)
    if abs(float(along @ gravity)) > 1e-6 * float(np.linalg.norm(gravity)):
        raise SceneError(
            [
                "motion.direction: must be across gravity to identify pendulums, got "
                f"{list(scene.motion.direction)}. Give a direction with no part along "
                f"{list(scene.gravity)}."
            ]
        )
    return scene


def with_runs(condition: Condition, folder: Path) -> Condition:
    """Write the tables that shake the tank below ``folder`` / ``RECORDS``, and plan the runs.

    ``folder`` is absolute. The step is the scene's, or a ``STEPS_A_PERIOD``-th of f1's period if
    that is less. Raises ``SceneError``.
    """
    slosh, amplitude = condition.slosh, condition.amplitude
    step = min(condition.scene.time.step, 1.0 / (STEPS_A_PERIOD * slosh))
    tables = {
        "sweep_up": ("sweep upwards", sweep(amplitude, slosh, step, upwards=True)),
        "sweep_down": ("sweep downwards", sweep(amplitude, slosh, step, upwards=False)),
        "record": ("record of random phase", random_record(amplitude, slosh, step)),
    }
    runs = []
    for name, (says, acceleration) in tables.items():
        file = folder / RECORDS / f"{condition.name}__{name}.csv"
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, _csv(step, acceleration, condition.scene.motion.unit_direction))
        changes: dict[str, Any] = {"motion.kind": "table", "motion.file": str(file)}
        runs.append((name, says, changes, step * (len(acceleration) - 1)))
    for ratio in CHECK_SINES:
        frequency = ratio * slosh
        changes = {
            "motion.kind": "sine",
            "motion.frequency": frequency,
            "motion.amplitude": amplitude,
            "motion.ramp": CHECK_RAMP,
        }
        runs.append((f"sine_{ratio:g}", f"sine of {frequency:.3g} Hz", changes,
                     CHECK_PERIODS / frequency))  # fmt: skip
    planned = tuple(
        Planned(
            name=name,
            says=says,
            fits=name.startswith("sweep"),
            scene=with_overrides(
                condition.scene, changes | {"time.step": step, "time.duration": duration}
            ),
            place=Path(POINTS) / condition.name / name,
        )
        for name, says, changes, duration in runs
    )
    return Condition(**{**vars(condition), "runs": planned})


def _csv(step: float, acceleration: Array, direction: Array) -> str:
    """A table of accelerations as ``motion.file`` takes it, to all digits."""
    text = io.StringIO()
    columns = [step * np.arange(len(acceleration)), *np.outer(direction, acceleration)]
    np.savetxt(
        text, np.stack(columns, axis=1), fmt="%.17g", delimiter=",", comments="",
        header="time (s),ax (m/s^2),ay (m/s^2),az (m/s^2)",
    )  # fmt: skip
    return text.getvalue()
