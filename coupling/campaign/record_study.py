"""What a study by a record says: errors by bands of frequency, and statistics of every model."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from coupling.metrics.comparison import Errors
from coupling.metrics.record import record_statistics
from coupling.metrics.record_errors import COMPARED, answered, band_errors, reference_bands
from coupling.metrics.record_verdict import record_verdict
from coupling.metrics.uncertainty import error_bars
from coupling.scene.scene import Scene
from coupling.store.step_series import StepSeries

Summary = Mapping[str, Any]


def record_study(
    scene: Scene,
    reference: str,
    models: Mapping[str, tuple[StepSeries, Summary]],
    own: Mapping[str, StepSeries],
    coarsening: Mapping[str, tuple[float, float]],
) -> dict[str, Any] | None:
    """The study's ``record``; None for a motion that follows none.

    Parameters
    ----------
    scene
        Scene of the ``reference``.
    reference
        Name of the row that the others are held against.
    models
        Steps and summary of every completed row as run, the reference's among them.
    own
        Steps of the reference's runs at other resolutions.
    coarsening
        By which factor each of those is coarser, and the order of its error.
    """
    best = models[reference][0]
    statistics = {name: record_statistics(steps, scene) for name, (steps, _) in models.items()}
    if statistics[reference] is None:
        return None
    bands = reference_bands(best, scene.liquid.density * scene.liquid_volume)
    errors = {
        name: band_errors(steps, best) for name, (steps, _) in models.items() if name != reference
    }
    apart = {name: band_errors(steps, best) for name, steps in own.items()}
    return {
        "bands": bands,
        "answered": answered(bands),
        "error": errors,
        "uncertainty": _bars(apart, coarsening),
        "models": {name: _figures(one, models[name][1]) for name, one in statistics.items() if one},
        "verdict": record_verdict(reference, bands, errors, _bars(apart, coarsening)),
    }


def _bars(
    apart: Mapping[str, Mapping[str, Errors]], coarsening: Mapping[str, tuple[float, float]]
) -> dict[str, Errors]:
    """The reference's own error by signal and band, as ``error_bars`` estimates it."""
    bars: dict[str, Errors] = {}
    for signal in COMPARED:
        own = {name: dict(found[signal]) for name, found in apart.items() if signal in found}
        names = list(dict.fromkeys(band for errors in own.values() for band in errors))
        bars[signal] = error_bars(own, coarsening, names)
    return bars


def _figures(statistics: Mapping[str, Any], summary: Summary) -> dict[str, Any]:
    """The row's rms, peaks and crossings of CG, force and moment, and its slip."""
    signals: Sequence[str] = [name for name in statistics["signals"] if name != "acceleration"]
    return {
        "levels_rms": statistics["levels_rms"],
        **{name: statistics["signals"][name] for name in signals},
        "shell_slip_max_m": (summary.get("rubbing") or {}).get("shell_slip_max_m"),
        "self_slip_max_m": (summary.get("rubbing") or {}).get("self_slip_max_m"),
    }
