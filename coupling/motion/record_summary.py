"""What is known of a measured record before it is run: in a line, and in warnings."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.motion import MOTIONS
from coupling.motion.shaking import attitude_of
from coupling.ports import Array
from coupling.scene.motion_table import NEAR_GRAVITY, MotionTable
from coupling.scene.scene import Scene
from coupling.scene.tables.columns import GRAVITY

_ENOUGH = 10  # samples from which on steps are called uneven
_MISSED = 1.5  # times the median step: one sample is missing
_FEW = 0.05  # share of the steps up to which longer ones are gaps
_UNEVEN = 0.1  # of the median step: spread of nine steps in ten
_NOTHING = 1e-7  # m/s^2: a mean below it is rounding
MATERIAL = 0.05  # share of the power above what the time step carries


@dataclass(frozen=True, kw_only=True)
class RecordSummary:
    """What the accelerations are that a scene's tank follows, measured or made.

    ``says``: what was read, in a line; ``rms_m_s2``: root mean square by axis; ``band_hz``: between
    which frequencies nine tenths of its power lie; ``power_above_step``: share of its power above
    half the rate of the time steps; ``warnings``: what may be wrong, a sentence and a mend each.
    """

    says: str
    rms_m_s2: tuple[float, ...]
    band_hz: tuple[float, float]
    power_above_step: float
    warnings: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Plain values by name."""
        return asdict(self)


def record_summary(scene: Scene) -> RecordSummary | None:
    """Of the accelerations that shake a scene's tank; None where it follows no record."""
    table = MOTIONS[scene.motion.kind].record(scene.motion)
    if table is None:
        return None
    above = table.power_above(_carried(scene))
    return RecordSummary(
        says=_line(scene, table, above),
        rms_m_s2=tuple(table.rms.tolist()),
        band_hz=table.band,
        power_above_step=above,
        warnings=(
            *_step_warnings(scene, table, above),
            *_gravity_warnings(scene, table),
            *_sampling_warnings(table),
        ),
    )


def _line(scene: Scene, table: MotionTable, above: float) -> str:
    rate = 1.0 / float(np.median(np.diff(table.time)))
    low, high = table.band
    peak = table.acceleration[np.argmax(np.sum(table.acceleration**2, axis=1))]
    return (
        f"record {Path(scene.motion.file or '').name}: {table.read}; {len(table.time)} samples at "
        f"{rate:.4g} Hz, {table.time[0]:.4g} to {table.time[-1]:.4g} s, "
        f"mean {_vector(table.mean)}, peak {_vector(peak)} m/s^2, rms {_vector(table.rms)} m/s^2, "
        f"nine tenths of its power between {low:.3g} and {high:.3g} Hz; "
        f"{100.0 * above:.3g} % of its power is above the "
        f"{_carried(scene):.4g} Hz that time.step = {scene.time.step:g} s carries{_turns(scene)}"
    )


def _turns(scene: Scene) -> str:
    """By how much a record turns the tank, in words; nothing where it does not."""
    turning = attitude_of(scene)
    if turning is None:
        return ""
    times = MOTIONS[scene.motion.kind].instants(scene.motion)
    matrices = np.array([turning.matrix(time) for time in times[times <= scene.time.end]])
    size = np.degrees(np.arccos(np.clip(0.5 * (np.trace(matrices.T) - 1.0), -1.0, 1.0)))
    upright = np.degrees(np.arccos(np.clip(matrices[:, 2, 2], -1.0, 1.0)))
    return (
        f"; it turns the tank by up to {size.max():.3g} degrees, and tilts it by up to "
        f"{upright.max():.3g}, the accelerations being turned with it"
    )


def _carried(scene: Scene) -> float:
    """Highest frequency [Hz] that steps of ``time.step`` can carry."""
    return 0.5 / scene.time.step


def _step_warnings(scene: Scene, table: MotionTable, above: float) -> list[str]:
    if above <= MATERIAL:
        return []
    frequency = table.characteristic_frequency
    return [
        f"{100.0 * above:.3g} % of the record's power is above {_carried(scene):.4g} Hz, half the "
        f"rate of the time steps, and is averaged out. Take time.step = {0.4 / frequency:.2g} or "
        "less to carry nine tenths of it, or leave it if the liquid does not feel what is faster."
    ]


def _gravity_warnings(scene: Scene, table: MotionTable) -> list[str]:
    size = float(np.linalg.norm(table.median))
    if any(scene.motion.at_rest or ()) and abs(size / GRAVITY - 1.0) < NEAR_GRAVITY:
        return [
            f"the record less motion.at_rest still has a median of {_vector(table.median)} m/s^2, "
            "near 1 g. Turn the sign of motion.at_rest, or take the axis of gravity in it."
        ]
    if not table.units_given and abs(size - 1.0) < NEAR_GRAVITY:
        return [
            f"the record's median is {size:.3g}, taken for m/s^2 since the file gives no unit: it "
            "seems to be in g and to contain gravity. Name the unit in the header, such as "
            "ax (g), and give motion.at_rest."
        ]
    return []


def _sampling_warnings(table: MotionTable) -> list[str]:
    steps = np.diff(table.time)
    median = float(np.median(steps))
    if len(table.time) < _ENOUGH:
        return []
    changed = np.any(table.acceleration[1:] != table.acceleration[:-1], axis=1)
    wide = (steps > _MISSED * median) & changed  # across the others the tank coasts
    if 0.0 < wide.mean() <= _FEW:
        first = int(np.argmax(wide))
        return [
            f"single samples of the record are missing, {int(wide.sum())} in all, the first behind "
            f"t = {table.time[first]:.4g} s; it is taken as linear there. More than one in a row "
            "are refused."
        ]
    low, high = np.quantile(steps, (0.05, 0.95))
    if high - low > _UNEVEN * median:
        return [
            f"the record's steps are uneven, {steps.min():.3g} to {steps.max():.3g} s. Check that "
            "its times are right; it is taken as linear between them."
        ]
    return []


def _vector(values: Array) -> str:
    least = max(1e-6 * np.abs(values).max(), _NOTHING)
    return "(" + ", ".join(f"{value:.3g}" if abs(value) > least else "0" for value in values) + ")"
