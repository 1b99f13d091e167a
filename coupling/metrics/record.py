"""What a run says that follows a record: rms and peaks, level crossings, bands of frequency."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.metrics.spectra import Spectrum, octaves, spectrum_of
from coupling.motion import MOTIONS
from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.step_series import StepSeries

LEVELS = tuple(0.5 * k for k in range(-10, 11))  # of crossings, in rms
UNITS = {"acceleration": "m/s^2", "cg": "m", "force": "N", "moment": "N m"}


def follows_record(scene: Scene) -> bool:
    """Whether the tank's motion is a record, measured or made, and has no period."""
    return MOTIONS[scene.motion.kind].record(scene.motion) is not None


def signals_of(steps: StepSeries) -> dict[str, Array]:
    """The signals (S, 3) of ``UNITS`` in a run's steps."""
    return {
        "acceleration": steps.tank_acceleration,
        "cg": steps.liquid_cg,
        "force": steps.force,
        "moment": steps.moment,
    }


def record_statistics(steps: StepSeries, scene: Scene) -> dict[str, Any] | None:
    """The summary's ``record``; None for a motion that follows none, or without a step.

    By signal, each of three components: ``mean``; ``rms`` and ``peak``, the largest size, both
    about the mean; ``crossings`` of the ``levels_rms``. ``bands``: rms in each octave, and its
    scatter between records of the same process (``random_error``); empty for a short run.
    """
    if not follows_record(scene) or len(steps.time) < 2:
        return None
    signals = signals_of(steps)
    spectra = {name: spectrum_of(steps.time, signal) for name, signal in signals.items()}
    return {
        "duration_s": float(steps.time[-1] - steps.time[0]),
        "levels_rms": list(LEVELS),
        "signals": {name: _figures(signal, UNITS[name]) for name, signal in signals.items()},
        "bands": _bands({name: one for name, one in spectra.items() if one is not None}),
    }


def _figures(signal: Array, unit: str) -> dict[str, Any]:
    mean = signal.mean(axis=0)
    about = signal - mean
    rms = np.sqrt(np.mean(about**2, axis=0))
    return {
        "unit": unit,
        "mean": mean,
        "rms": rms,
        "peak": np.abs(about).max(axis=0),
        "crossings": [
            crossings(part, float(size)) for part, size in zip(about.T, rms, strict=True)
        ],
    }


def crossings(about: Array, rms: float) -> list[int]:
    """How often a signal (S,) about its mean crosses each of ``LEVELS`` times its ``rms``.

    Away from the mean: upwards at levels from 0 on, downwards below (ASTM E1049, level crossing
    counting). Between two instants a level counts once. A Gaussian signal crosses l rms
    exp(-l^2/2) times as often as 0 (Rice, Bell System Technical Journal 24, 1945).
    """
    if rms == 0.0:
        return [0] * len(LEVELS)
    counts = []
    for level in LEVELS:
        side = 1.0 if level >= 0.0 else -1.0
        beyond = side * about > side * level * rms
        counts.append(int(np.count_nonzero(beyond[1:] & ~beyond[:-1])))
    return counts


def _bands(spectra: dict[str, Spectrum]) -> list[dict[str, Any]]:
    if not spectra:
        return []
    first = spectra["acceleration"]
    return [
        {
            "from_hz": band[0],
            "to_hz": band[1],
            "random_error": first.random_error(band),
            "rms": {name: np.sqrt(one.power(band)) for name, one in spectra.items()},
        }
        for band in octaves(first)
    ]
