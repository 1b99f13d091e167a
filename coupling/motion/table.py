"""A tank shaken by accelerations from a file."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from scipy.interpolate import make_interp_spline

from coupling.motion.kind import MotionKind, TankMotion
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
        """Mean over the step, carried from its middle to its end [m/s^2].

        Carried along the line through the mean over the step before. This is the difference of the
        tank's velocity, the integral of the table, by the steps' own implicit formula
        (``cloth.kinematics``): a body that nothing holds changes its velocity in every step by the
        integral over it, exactly. A sample would take what is faster than the steps for slow motion
        or miss it, and the mean alone, used at the step's end, would be late by half a step.
        """
        step = end - start
        mean = self.working_acceleration(start, end)
        if previous <= 0.0:
            return mean
        before = self.working_acceleration(start - previous, start)
        return mean + step / (step + previous) * (mean - before)

    def working_acceleration(self, start: float, end: float) -> Array:
        """Mean over the step [m/s^2]: the tank's change of velocity over the step's length."""
        change = self._velocity(end) - self._velocity(start)
        return np.asarray(change / (end - start), dtype=np.float64)


class Table(MotionKind):
    """Accelerations from a CSV file, read once (``Motion.record``)."""

    needs = ("file",)
    takes = ("at_rest",)
    reads_file = True

    def motion(self, section: Motion) -> TankMotion:
        """Of the section's record."""
        return TableMotion(section.record)

    def record(self, section: Motion) -> MotionTable | None:
        """The section's table."""
        return section.record

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
        return []

    def characteristic_frequency(self, section: Motion) -> float:
        """That of the record."""
        return section.record.characteristic_frequency

    def peak_accelerations(self, section: Motion) -> Array:
        """All of the table's lines, within the run or not."""
        return section.record.acceleration

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """The file's name."""
        return (f"table {Path(section.file or '').name}",)


def _upright(vector: Array) -> list[float]:
    """Gravity along the axis that a ``vector`` (3,) is nearest to."""
    axis = int(np.argmax(np.abs(vector)))
    return [math.copysign(GRAVITY, vector[axis]) if k == axis else 0.0 for k in range(3)]


TABLE = Table()
