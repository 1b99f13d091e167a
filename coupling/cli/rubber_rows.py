"""What the command line prints of the rubber: its folds, and where it rubs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_FOLDS = {
    "folds, most": "number_max",
    "... radius that the sharpest tenth is bent to [m]": "sharpest_tenth_radius_m",
    "... sharpest radius of curvature [m]": "sharpest_radius_m",
    "... over the thickness": "sharpest_radius_over_thickness",
    "... there from the moulded pole, azimuth [deg]": "sharpest_place_deg",
    "area folded over, most, of the whole": "folded_area_max_fraction",
    "steps with layers in touch, of all": "layers_touch_share_of_steps",
}
_RUBS = {
    "largest slip on the shell [m]": "shell_slip_max_m",
    "... largest slip work [J/m^2]": "shell_work_max_J_per_m2",
    "... there from the moulded pole, azimuth [deg]": "shell_work_place_deg",
    "... there from the shell's lower pole, azimuth [deg]": "shell_work_on_shell_deg",
    "... worn off there, least, largest [m]": "shell_wear_max_m",
    "largest slip on itself [m]": "self_slip_max_m",
    "... largest slip work on itself [J/m^2]": "self_work_max_J_per_m2",
    "... there from the moulded pole, azimuth of it [deg]": "self_work_place_deg",
    "... worn off itself there, least, largest [m]": "self_wear_max_m",
}


def rubber_rows(summary: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Rows of a run's ``summary``: name and value; those of which there is none are left out."""
    folds, rubs = summary.get("folds") or {}, summary.get("rubs") or {}
    rows = [
        (text, part[name])
        for names, part in ((_FOLDS, folds), (_RUBS, rubs))
        for text, name in names.items()
        if part.get(name) is not None
    ]
    return [("folds", "below the grid"), *rows] if folds.get("below_grid") else rows
