"""How far a study's reference knows its ratios of Bernoulli's parts, by its own coarser runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coupling.metrics.uncertainty import error_bars

MEASURED = ("kinetic_ratio", "unsteady_ratio", "dynamic_fraction", "neglected_momentum")


def with_errors(
    reference: Mapping[str, Any],
    coarser: Mapping[str, Mapping[str, Any]],
    coarsening: Mapping[str, tuple[float, float]],
) -> dict[str, dict[str, float | None]]:
    """Return the reference's ratios, those that it has, each with its estimated error.

    Parameters
    ----------
    reference
        Its summary.
    coarser
        Summaries of its runs with a numerical source of error enlarged, by source.
    coarsening
        By how much each was enlarged, and the order of its error.

    Returns
    -------
    dict
        By ratio ``value`` and ``uncertainty`` [-], None where that is not known.
    """
    ratios = reference.get("bernoulli") or {}
    measured = {name: value for name in MEASURED if (value := ratios.get(name)) is not None}
    own = {
        source: {
            name: abs(other - value)
            for name, value in measured.items()
            if (other := (summary.get("bernoulli") or {}).get(name)) is not None
        }
        for source, summary in coarser.items()
    }
    bars = error_bars(own, coarsening, list(measured))
    return {name: {"value": value, "uncertainty": bars[name]} for name, value in measured.items()}
