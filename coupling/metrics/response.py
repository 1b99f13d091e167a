"""How the liquid answers the shaking: amplitudes, phases and peaks of its CG, force and moment."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.metrics.forces import momentum_imbalance
from coupling.metrics.gravity_centre import peak_amplitude
from coupling.metrics.harmonic import (
    Harmonic,
    first_harmonic,
    last_whole_periods,
    phasor_drift,
    spans_two_periods,
)
from coupling.metrics.transfer import tank_phasor, transfer
from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.attitude import body_force, in_ground, in_tank
from coupling.store.step_series import StepSeries

STEADY = 0.05  # drift of a phasor above which it is one of a transient


def harmonics(steps: StepSeries, scene: Scene) -> dict[str, Harmonic]:
    """First harmonics of ``cg``, ``force``, ``moment``, and the tank's motion, by name.

    In the tank's axes; ``cg_in_ground`` and the displacement in axes that do not turn. Empty where
    there is no period, or no whole one in the run.
    """
    frequency = scene.frequency
    if frequency is None:
        return {}
    ramp = scene.motion.ramp / frequency
    chosen, periods = last_whole_periods(steps.time, frequency, start=ramp)
    if periods == 0:
        return {}
    signals = {
        "cg": steps.liquid_cg,
        "cg_in_ground": in_ground(steps.liquid_cg, steps),
        "force": steps.force,
        "moment": steps.moment,
        "displacement": steps.tank_displacement,
        "rotation": steps.tank_rotation,
    }
    return {
        name: first_harmonic(steps.time[chosen], signal[chosen], frequency, periods=periods)
        for name, signal in signals.items()
    }


def shaking_frequency(steps: StepSeries, scene: Scene) -> float | None:
    """The frequency of shaking [Hz] that a response can be read at; None without any.

    None too where the tank is shaken by less than ``time.settle_tolerance`` of gravity: what the
    diaphragm's settling has left moves the liquid as much. A tilt shakes by what of gravity turns.
    """
    gravity = np.array(scene.gravity)
    shaken = np.linalg.norm(gravity - body_force(gravity, steps), axis=1).max(initial=0.0)
    least = scene.time.settle_tolerance * float(np.linalg.norm(scene.gravity))
    return scene.frequency if shaken > least else None


def cg_summary(steps: StepSeries, scene: Scene, fits: dict[str, Harmonic]) -> dict[str, Any]:
    """The summary's ``cg``; ``fits`` are the run's ``harmonics``."""
    return (
        _moving(steps.liquid_cg, fits, "cg", "m")
        | {"mean_m": _mean(steps.liquid_cg, fits), "transfer": _transfer(fits, "cg")}
        | _steadiness(steps.time, steps.liquid_cg, shaking_frequency(steps, scene))
    )


def force_summary(steps: StepSeries, scene: Scene, fits: dict[str, Harmonic]) -> dict[str, Any]:
    """The summary's ``force``; ``fits`` are the run's ``harmonics``."""
    weight = weight_of(steps, scene)
    return (
        _moving(steps.force, fits, "force", "N")
        | {"momentum_imbalance": _imbalance(steps, scene, fits)}
        | _steadiness(steps.time, steps.force, shaking_frequency(steps, scene))
        | {"peak_N": _peak(steps.force), "peak_dynamic_N": _peak(steps.force - weight)}
        | {"transfer": _transfer(fits, "force", inertia=_inertia(scene))}
    )


def weight_of(steps: StepSeries, scene: Scene) -> Array:
    """Weight (S, 3) [N] of the liquid at every step, in the tank's axes."""
    drawn = scene.supply.drawn
    volume = steps.volume if drawn else np.full(len(steps.time), scene.liquid_volume)
    return in_tank(scene.liquid.density * np.outer(volume, scene.gravity), steps)


def moment_summary(steps: StepSeries, fits: dict[str, Harmonic]) -> dict[str, Any]:
    """The summary's ``moment``; ``fits`` are the run's ``harmonics``."""
    return _moving(steps.moment, fits, "moment", "Nm") | {"peak_Nm": _peak(steps.moment)}


def _moving(signal: Array, fits: dict[str, Harmonic], name: str, unit: str) -> dict[str, Any]:
    if fits:
        tank = fits["displacement"].coefficient
        if not tank.any():  # its middle stays
            tank = fits["rotation"].coefficient
        reference = complex(tank[np.argmax(np.abs(tank))])
        return {
            f"amplitude_{unit}": fits[name].amplitude,
            "phase_deg": fits[name].phase_deg(reference),
        }
    amplitude = peak_amplitude(signal) if len(signal) > 1 else [None] * 3
    return {f"amplitude_{unit}": amplitude, "phase_deg": [None] * 3}


def _steadiness(time: Array, signal: Array, frequency: float | None) -> dict[str, Any]:
    """``drift`` of the phasor, and whether it is one of a ``transient``.

    A run of less than two periods counts as one; without a period, or where nothing moves, it is
    not known.
    """
    if frequency is None or not len(time):
        return {"drift": None, "transient": None}
    if not spans_two_periods(time, frequency):
        return {"drift": None, "transient": True}
    drift = phasor_drift(time, signal, frequency)
    return {"drift": drift, "transient": None if drift is None else drift > STEADY}


def _transfer(fits: dict[str, Harmonic], name: str, inertia: float = 1.0) -> dict[str, Any] | None:
    """Of ``name`` over ``inertia`` times the tank's displacement; None without a period."""
    if not fits:
        return None
    return transfer(fits[name], inertia * tank_phasor(fits["displacement"].coefficient))


def _inertia(scene: Scene) -> float:
    """m omega^2 [N/m] of the liquid."""
    mass = scene.liquid.density * scene.liquid_volume
    return mass * (2.0 * np.pi * (scene.frequency or 0.0)) ** 2


def _peak(signal: Array) -> Any:
    return np.abs(signal).max(axis=0) if len(signal) else [None] * 3


def _mean(signal: Array, fits: dict[str, Harmonic]) -> Any:
    if fits:
        return fits["cg"].mean
    return signal.mean(axis=0) if len(signal) else [None] * 3


def _imbalance(steps: StepSeries, scene: Scene, fits: dict[str, Harmonic]) -> float | None:
    frequency = shaking_frequency(steps, scene)
    if frequency is None or not fits:
        return None
    return momentum_imbalance(
        steps.time,
        force=in_ground(steps.force, steps),
        cg=in_ground(steps.liquid_cg, steps),
        acceleration=steps.tank_acceleration,
        gravity=np.array(scene.gravity),
        mass=scene.liquid.density * scene.liquid_volume,
        frequency=frequency,
        periods=fits["cg"].periods,
    )
