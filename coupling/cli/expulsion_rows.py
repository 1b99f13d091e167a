"""What the command line prints of liquid that was drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_EXPULSION = {
    "fill fraction, end": "fill_fraction_end",
    "pressure drop across the diaphragm, largest [Pa]": "pressure_drop_max_Pa",
    "... at a fill fraction of": "pressure_drop_max_at_fill",
    "... mean over the drawn volume [Pa]": "pressure_drop_mean_Pa",
    "... corrected for the grid's chords by, rms [Pa]": "pressure_drop_chords_Pa",
    "... of the mean taken by damping [Pa]": "pressure_drop_damping_Pa",
    "work of the pressure drop [J]": "work_J",
    "outlet covered at a fill fraction of": "outlet_covered_at_fill",
    "liquid left then [m^3]": "residual_volume_m3",
    "folded over most at a fill fraction of": "folded_area_max_at_fill",
    "most folds at a fill fraction of": "folds_max_at_fill",
    "liquid's inertia over its weight": "inertia_ratio",
}


def expulsion_rows(summary: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Rows of a run's ``summary``: name and value; none where nothing was drawn."""
    found = summary.get("expulsion") or {}
    return [(text, found[name]) for text, name in _EXPULSION.items() if found.get(name) is not None]
