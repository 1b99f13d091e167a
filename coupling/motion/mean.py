"""What drives a step of a motion that is faster than the steps: means over them."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from coupling.ports import Array

Velocity = Callable[[float], Array]


def mean_over(velocity: Velocity, start: float, end: float) -> Array:
    """Mean acceleration (3,) [m/s^2] over a step: the change of ``velocity`` over its length."""
    return np.asarray((velocity(end) - velocity(start)) / (end - start), dtype=np.float64)


def carried_mean(velocity: Velocity, start: float, end: float, previous: float) -> Array:
    """Mean acceleration (3,) [m/s^2] over the step, carried from its middle to its end.

    Carried along the line through the mean over the step before, of a length of ``previous`` [s].
    This is the difference of ``velocity``, the integral of the accelerations, by the steps' own
    implicit formula (``cloth.kinematics``): a body that nothing holds changes its velocity in every
    step by the integral over it, exactly. A sample would take what is faster than the steps for
    slow motion or miss it, and the mean alone, used at the step's end, would be late by half a
    step.
    """
    step = end - start
    mean = mean_over(velocity, start, end)
    if previous <= 0.0:
        return mean
    before = mean_over(velocity, start - previous, start)
    return mean + step / (step + previous) * (mean - before)
