"""Where a run's energy went: by period, and by what took it."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.ports import Array
from coupling.store.step_series import StepSeries

SHARES = {
    "liquid_J": "dissipated_by_liquid",
    "stretch_loss_J": "dissipated_by_stretch",
    "shell_friction_J": "dissipated_by_shell_friction",
    "self_friction_J": "dissipated_by_self_friction",
    "bending_damping_J": "dissipated_by_bending",
    "drag_J": "dissipated_by_drag",
}
WITHIN_LIQUID = {"wall_layers_J": "dissipated_by_layers", "removed_J": "energy_removed"}
REGULARISATIONS = ("bending_damping_J", "drag_J")  # stand for no loss of the rubber's


def rest(metrics: dict[str, Array]) -> Array:
    """Return what of ``dissipated`` (T,) [J] neither the liquid nor a named loss of the sheet took.

    It comes from the sheet's impacts on the shell and on itself, from where it snaps taut, and from
    the time stepping. Negative where those add energy.
    """
    known = sum((metrics[name] for name in SHARES.values() if name in metrics), np.zeros(1))
    return np.asarray(metrics["dissipated"] - known)


def energy_summary(steps: StepSeries, frequency: float | None, periods: int) -> dict[str, Any]:
    """Energies [J] of a run, from the balance that ``simulation.energy`` sums over every step.

    ``work_J`` and ``dissipated_J`` since the start; ``peak_J``: the largest mechanical energy above
    the start's, of liquid and sheet. ``per_period``: means over the last ``periods`` of
    ``frequency`` [Hz], ``fraction`` what is dissipated over the largest energy in them,
    ``regularised_fraction`` what of it ``cloth.fold_damping`` and ``cloth.slack_drag`` take, None
    where nothing is dissipated; None without a period. ``wall_layers_J`` and ``removed_J`` stand
    within ``liquid_J``, None where the model has no such formula or rule; ``wall_layer_estimate_J``
    stands beside the balance.
    Null without a balance.
    """
    metrics = steps.metrics
    if "dissipated" not in metrics or len(steps.time) == 0:
        return dict.fromkeys(("work_J", "dissipated_J", "peak_J", "per_period"))
    work = metrics["tank_work"] + metrics["datum_work"]
    return {
        "work_J": work[-1],
        "dissipated_J": metrics["dissipated"][-1],
        "peak_J": metrics["mechanical_energy"].max(),
        "per_period": _per_period(steps, work, frequency, periods)
        if periods and frequency
        else None,
    }


def _per_period(steps: StepSeries, work: Array, frequency: float, periods: int) -> dict[str, Any]:
    metrics, time = steps.metrics, steps.time
    start = float(time[-1]) - periods / frequency

    def a_period(sums: Array) -> float:
        return float(sums[-1] - np.interp(start, time, sums)) / periods

    peak = float(metrics["mechanical_energy"][time >= start].max())
    dissipated = a_period(metrics["dissipated"])
    within = {name: metrics.get(key) for name, key in WITHIN_LIQUID.items()}
    layer = a_period(metrics["layer_estimate"])
    shares = {name: a_period(metrics[key]) for name, key in SHARES.items() if key in metrics}
    regularised = sum(shares[name] for name in REGULARISATIONS)
    return {
        "work_J": a_period(work),
        "dissipated_J": dissipated,
        "fraction": dissipated / peak if peak > 0.0 else None,
        "peak_J": peak,
        "regularised_fraction": regularised / dissipated if dissipated > 0.0 else None,
        **shares,
        "rest_J": a_period(rest(metrics)),
        **{name: None if sums is None else a_period(sums) for name, sums in within.items()},
        "wall_layer_estimate_J": layer if layer > 0.0 else None,
    }
