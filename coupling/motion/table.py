"""A tank shaken by accelerations from a file."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import lru_cache
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from coupling.motion.attitude import AngleAttitude, RateAttitude
from coupling.motion.kind import Attitude, MotionKind, TankMotion
from coupling.motion.lever import LeverMotion
from coupling.motion.mean import carried_mean, mean_over
from coupling.ports import Array
from coupling.scene.motion_table import NEAR_GRAVITY, MotionTable
from coupling.scene.sections import Motion
from coupling.scene.tables.columns import GRAVITY
from coupling.scene.tables.text import TableError


class TableMotion:
    """Tabulated accelerations, linear between them and integrated exactly.

    Displacement and velocity are 0 at time 0, so a table with a mean acceleration drifts away:
    what the liquid feels depends on the acceleration alone. Times outside the table extrapolate.
    """

    def __init__(self, table: MotionTable) -> None:
        linear = make_interp_spline(table.time, table.acceleration, k=1, axis=0)
        self._acceleration = linear
        self._velocity = linear.antiderivative(1)
        self._displacement = linear.antiderivative(2)

    def displacement(self, time: float) -> Array:
        """Second integral from time 0 [m]."""
        start = self._displacement(0.0) + self._velocity(0.0) * time
        return np.asarray(self._displacement(time) - start, dtype=np.float64)

    def velocity(self, time: float) -> Array:
        """First integral from time 0 [m/s]."""
        return np.asarray(self._velocity(time) - self._velocity(0.0), dtype=np.float64)

    def acceleration(self, time: float) -> Array:
        """Interpolated [m/s^2]."""
        return np.asarray(self._acceleration(time), dtype=np.float64)

    def step_acceleration(self, start: float, end: float, previous: float) -> Array:
        """Mean over the step, carried from its middle to its end [m/s^2]: ``carried_mean``."""
        return carried_mean(self._velocity, start, end, previous)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean over the step [m/s^2]: the tank's change of velocity over the step's length."""
        return mean_over(self._velocity, start, end)


@lru_cache(maxsize=2)  # a run asks for the same record again and again
def _attitude_of(table: MotionTable) -> RateAttitude | AngleAttitude | None:
    if table.rates is not None:
        return RateAttitude(table.time, table.rates)
    return None if table.angles is None else AngleAttitude(table.time, table.angles)


@lru_cache(maxsize=2)
def _unturned(table: MotionTable, at_rest: tuple[float, float, float]) -> MotionTable:
    """A ``table`` with rotation in axes that do not turn, less what an upright tank shows at rest.

    A logger on the tank shows R^T (a - g) where it contains gravity, and R^T a where not: R times
    that, less -g or 0.
    """
    turning = _attitude_of(table)
    assert turning is not None
    turned = np.einsum("kij,kj->ki", turning.matrices(table.time), table.acceleration)
    return replace(table, acceleration=turned).less(at_rest)


class Table(MotionKind):
    """Accelerations from a CSV file, read once (``Motion.record``)."""

    needs = ("file",)
    takes = ("at_rest", "point")
    reads_file = True

    def motion(self, section: Motion) -> TankMotion:
        """Of the section's record, at the tank's origin."""
        of_point, turning = TableMotion(self._unturned(section)), self.attitude(section)
        if turning is None:
            return of_point
        return LeverMotion(of_point, turning, np.array(section.point or (0.0, 0.0, 0.0)))

    def attitude(self, section: Motion) -> Attitude | None:
        """Of the record's angular rates or angles, None where it has neither."""
        return _attitude_of(section.record)

    def turns(self, section: Motion) -> bool:
        """Whether the record has angular rates or angles; a record that cannot be read has none."""
        try:
            return section.file is not None and section.record.turns
        except TableError:
            return False

    def _unturned(self, section: Motion) -> MotionTable:
        """The section's record in axes that do not turn."""
        if not section.record.turns:
            return section.record
        return _unturned(section.record, section.at_rest or (0.0, 0.0, 0.0))

    def record(self, section: Motion) -> MotionTable | None:
        """The section's table, in axes that do not turn."""
        return self._unturned(section)

    def problems(self, section: Motion, end: float, step: float) -> list[str]:
        """A table that cannot be read, may contain gravity or does not cover the run."""
        del step
        if section.file is None:  # said of the missing key
            return []
        try:
            table = section.record
        except TableError as error:
            return [f"motion.file: {error}"]
        median = table.median
        near = np.linalg.norm(median) / GRAVITY
        if section.at_rest is None and abs(near - 1.0) < NEAR_GRAVITY:
            said = ", ".join(f"{value:.4g}" for value in median)
            return [
                f"motion.file: {section.file}: its median is ({said}) m/s^2, near 1 g, and nothing "
                "says whether it contains gravity, which the scene adds itself. Give "
                f"motion.at_rest = {_upright(median)}, what it shows of a tank at rest, or "
                "[0.0, 0.0, 0.0] if the tank is really accelerated so."
            ]
        first, last = float(table.time[0]), float(table.time[-1])
        if first > 0.0 or last < end * (1.0 - 1e-9):
            return [
                f"motion.file: {section.file}: must cover 0 to {end:g} s, covers {first:g} to "
                f"{last:g} s. Shorten time.duration, or give a longer table that starts at 0."
            ]
        return self._upside_down(section, table.time[table.time <= end])

    def _upside_down(self, section: Motion, time: Array) -> list[str]:
        """Whether the tank lies on its side or worse at one of the times (k,) [s]."""
        turning = _attitude_of(section.record)
        if turning is None:
            return []
        over = time[turning.matrices(time)[:, 2, 2] <= 0.0]
        if not len(over):
            return []
        return [
            f"motion.file: {section.file}: turns the tank by 90 degrees or more, first at "
            f"{over[0]:g} s; no run that turns over was held against another answer. Check the "
            "units and the signs of its rotation, or end time.duration before."
        ]

    def instants(self, section: Motion) -> Array:
        """Samples of the record, 2000 at the most."""
        time = section.record.time
        return np.asarray(time[:: 1 + len(time) // 2000])

    def characteristic_frequency(self, section: Motion) -> float:
        """That of the record; with rotation that of the body force, of which a tilt is a part."""
        table, turning = self._unturned(section), _attitude_of(section.record)
        if turning is None:
            return table.characteristic_frequency
        body = np.array([0.0, 0.0, -GRAVITY]) - table.acceleration
        felt = np.einsum("kij,ki->kj", turning.matrices(table.time), body)
        return replace(table, acceleration=felt).characteristic_frequency

    def peak_accelerations(self, section: Motion) -> Array:
        """All of the table's lines, within the run or not, where they were measured."""
        return self._unturned(section).acceleration

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """The file's name."""
        return (f"table {Path(section.file or '').name}",)


def _upright(vector: Array) -> list[float]:
    """Gravity along the axis that a ``vector`` (3,) is nearest to."""
    axis = int(np.argmax(np.abs(vector)))
    return [math.copysign(GRAVITY, vector[axis]) if k == axis else 0.0 for k in range(3)]


TABLE = Table()
