"""The diaphragm's static equilibrium, from the moulded shape."""

from __future__ import annotations

import logging
from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array
from cloth.load import Load
from cloth.step import Cloth

log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class _Ramped:
    density: float
    body_force: Array
    volume: float | None
    datum: float | None


@dataclass(frozen=True, kw_only=True)
class Settled:
    """``steps`` done; ``change`` [m]: the last step's rms displacement; ``converged``."""

    steps: int
    change: float
    converged: bool


def settle(
    cloth: Cloth,
    load: Load,
    *,
    dt: float = 0.03,
    ramp_steps: int = 100,
    tolerance: float = 1e-6,
    steps_max: int = 1000,
) -> Settled:
    """Bring ``cloth`` to rest under ``load``, in place.

    Implicit Euler steps of ``dt`` [s] that forget their velocity: each lowers the potential energy
    and none carries momentum. The volume goes from where it is to ``load.volume`` as a smooth
    ramp over ``ramp_steps``; then steps go on until the rms displacement of a step stays below
    ``tolerance`` shell radii for ten steps. With a given datum there is no ramp.
    """
    if cloth.held:
        return Settled(steps=0, change=0.0, converged=True)
    begin = cloth.state.volume
    zero = np.zeros_like(cloth.reference)
    limit = tolerance * cloth.model.shell_radius
    position = cloth.state.position
    change, quiet = np.inf, 0
    cloth.halt()
    for step in range(1, steps_max + 1):
        s = min(1.0, step / ramp_steps)
        volume = load.volume
        if volume is not None:
            volume = begin + (volume - begin) * s * s * (3.0 - 2.0 * s)
        cloth.begin_step(
            dt,
            _Ramped(
                density=load.density,
                body_force=load.body_force,
                volume=volume,
                datum=load.datum,
            ),
        )
        cloth.solve(zero)
        cloth.accept_step()
        cloth.halt()
        moved = cloth.state.position
        change = float(np.sqrt(np.mean(np.sum((moved - position) ** 2, axis=1))))
        position = moved
        quiet = quiet + 1 if s >= 1.0 and change <= limit else 0
        if quiet >= 10:
            log.info("settled after %d steps, rms change %.1e m", step, change)
            return Settled(steps=step, change=change, converged=True)
    log.warning(
        "not settled after %d steps: rms change %.1e m a step, tolerance %.1e m. "
        "Raise steps_max, or begin with fewer rings.",
        steps_max,
        change,
        limit,
    )
    return Settled(steps=steps_max, change=change, converged=False)
