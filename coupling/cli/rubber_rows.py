"""What the command line prints of the rubber: where it rubs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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
    rubs = summary.get("rubs") or {}
    return [(text, rubs[name]) for text, name in _RUBS.items() if rubs.get(name) is not None]
