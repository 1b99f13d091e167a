"""What is kept of a design curve: one row a radius, and of each its runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from cloth.mould import Mould
from coupling.campaign.bracket import SCAN, WIDTH, Bracket, Trial, bracket_of
from coupling.campaign.design_plan import KEPT, DesignPlan
from coupling.scene.scene import Scene
from coupling.scene.wrinkles import shortest_wavelength

_PARTS = 2000  # of the meridian; frusta err by 1/(24 n^2) pi^2/4 of a hemisphere's area
# What a bracket's row says of its end, as design.csv has it: of the run that has enough.
_FIGURES = ("mass_kg", "thickness_over_radius", "wavelength_over_radius")


def trial_of(plan: DesignPlan, scene: Scene, summary: Mapping[str, Any]) -> Trial:
    """What a run of ``scene`` gave for the criterion, by its ``summary``."""
    if summary.get("status") != "completed":
        return Trial(failure=str(summary.get("error") or "no reason was given"))
    value = plan.measure.value(summary, scene)
    if value is None or not np.isfinite(value):
        return Trial(failure=f"its summary does not give the {plan.measure.figure}")
    return Trial(value=float(value))


def run_row(point: str, scene: Scene, trial: Trial, limit: float) -> dict[str, Any]:
    """One run: its thickness [m], mass of the diaphragm [kg], value and whether that is kept.

    ``point``: the name of its folder.
    """
    radius, thickness = scene.tank.radius, scene.diaphragm.thickness
    wavelength = shortest_wavelength(scene.diaphragm, scene.liquid, np.array(scene.gravity))
    return {
        "point": point,
        "radius_m": radius,
        "thickness_m": thickness,
        "mass_kg": scene.sheet.area_density * _area(scene.mould),
        "thickness_over_radius": thickness / scene.tank.shell.size,
        "wavelength_over_radius": wavelength / scene.tank.shell.size,
        "status": "failed" if trial.value is None else "completed",
        "value": trial.value,
        "kept": None if trial.value is None else trial.value < limit,
        "failure": trial.failure,
    }


def radius_row(
    radius: float,
    tried: Mapping[float, Trial],
    runs: Mapping[float, dict[str, Any]],
    limit: float,
    *,
    finished: bool,
) -> dict[str, Any]:
    """One radius [m]: its bracket, what is to be said of it, and its runs.

    ``tried`` and the ``runs``' rows are by thickness [m]; ``finished``: whether none is to come.
    """
    found = bracket_of(tried, limit)
    enough = {} if found.enough is None else runs[found.enough]
    status = _status(found, tried) if finished else "not finished"
    return {
        "radius_m": radius,
        "status": status,
        "too_thin_m": found.too_thin,
        "enough_m": found.enough,
        "value_too_thin": None if found.too_thin is None else runs[found.too_thin]["value"],
        "value_enough": enough.get("value"),
        **{name: enough.get(name) for name in _FIGURES},
        "monotonic": not (found.thin_keepers or found.rises),
        "remarks": _remarks(found, tried),
        "runs": [runs[thickness] for thickness in sorted(runs)],
    }


def _status(found: Bracket, tried: Mapping[float, Trial]) -> str:
    if found.closed:
        return "bracketed"
    if found.enough is None:
        return "exceeded throughout" if found.too_thin is not None else "all runs failed"
    if found.too_thin is None:
        return "kept throughout"
    return "a run between failed"


def _remarks(found: Bracket, tried: Mapping[float, Trial]) -> list[str]:
    remarks = []
    if found.thin_keepers:
        listed = ", ".join(f"{1e3 * one:.4g}" for one in found.thin_keepers)
        remarks.append(
            f"not monotonic: {listed} mm keep the limit, but {1e3 * (found.too_thin or 0.0):.4g} "
            "mm, thicker, does not. The bracket is the one above which all runs keep it"
        )
    for thinner, thicker in found.rises:
        values = (tried[one].value or 0.0 for one in (thinner, thicker))
        remarks.append(
            f"not monotonic: from {1e3 * thinner:.4g} to {1e3 * thicker:.4g} mm the value rises "
            f"from {next(values):.3g} to {next(values):.3g}"
        )
    failed = [f"{1e3 * one:.4g}" for one in sorted(tried) if tried[one].value is None]
    if failed:
        remarks.append(f"runs failed at {', '.join(failed)} mm")
    return remarks


def design_json(plan: DesignPlan, title: str, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What ``design.json`` holds; ``rows`` of the radii."""
    return {
        "title": title,
        "model": plan.model,
        "criterion": plan.criterion,
        "figure": plan.measure.figure,
        "reservation": plan.measure.reservation,
        "limit": plan.limit,
        "same": KEPT,
        "searched": [
            {"radius_m": radius, "least_m": ends[0], "largest_m": ends[1]}
            for radius, ends in zip(plan.radii, plan.ends, strict=True)
        ],
        "bracket_width": WIDTH,
        "scan": SCAN,
        "rows": list(rows),
    }


def curve_lines(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """The radii of ``design_json`` as lines of a table."""
    return [
        {name: value for name, value in row.items() if name not in {"runs", "remarks"}}
        | {"runs": len(row["runs"]), "remarks": "; ".join(row["remarks"])}
        for row in content["rows"]
    ]


def run_lines(content: Mapping[str, Any]) -> list[dict[str, Any]]:
    """All runs of ``design_json`` as lines of a table, failed ones with their reason."""
    return [dict(run) for row in content["rows"] for run in row["runs"]]


def _area(mould: Mould) -> float:
    """Area [m^2] of a moulded sheet, by frusta."""
    radius, height = np.array([mould.ring(number, _PARTS) for number in range(_PARTS + 1)]).T
    slant = np.hypot(np.diff(radius), np.diff(height))
    return float(np.pi * (slant * (radius[:-1] + radius[1:])).sum())
