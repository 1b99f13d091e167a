"""The report of a study: all models over each other, and their errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from coupling.metrics.advice import worst
from coupling.report.figures import model_legend, overlay, speed_figure
from coupling.report.files import RunFiles, pressure_rms, read_run
from coupling.report.instants import overlaid_sections
from coupling.report.page import Page, Picture, Section, Table, number, percent
from coupling.report.run_report import pressure_section, provenance, quality_section
from coupling.report.scene_table import scene_tables

_COLUMNS = {
    "shape_rms": "shape (rms/R)",
    "cg_amplitude": "CG amplitude",
    "cg_phase_deg": "CG phase",
    "force_amplitude": "force amplitude",
    "pressure_rms": "pressure (rms)",
}


def study_page(folder: Path, study: Mapping[str, Any]) -> Page:
    """Page of a study from ``study.json`` and the folders of its runs."""
    rows = study["models"]
    runs = [
        read_run(folder / name)
        for name, row in rows.items()
        if row["status"] == "completed" and (folder / name / "results.h5").is_file()
    ]
    runs.sort(key=lambda run: run.model != study["reference"])  # the others lie on top of it
    failed = [f"{name}: {row['failure']}" for name, row in rows.items() if row.get("failure")]
    sections = [_errors(study)]
    if runs:
        sections += [*_curves(runs, study), _shapes(runs), *_reference(runs), _scene(runs[0])]
    title = runs[0].scene.title if runs else ""
    return Page(
        title=f"{title or folder.resolve().name}: fluid models compared",
        subtitle=f"{', '.join(rows)} · errors against {study['reference'] or 'nothing'}",
        verdict=study["advice"],
        explanation=_measured(study),
        alarm="; ".join(failed),
        sections=sections,
        footer=provenance(runs[0]) if runs else "",
    )


def _measured(study: Mapping[str, Any]) -> str:
    row = study["models"].get(study["reference"]) or {}
    figures_of = row.get("bernoulli") or {}
    momentum, dynamic = figures_of.get("neglected_momentum"), figures_of.get("dynamic_fraction")
    if not dynamic or momentum is None:
        return "The reference has no flow of its own: what hydrostatics leaves out is not measured."
    return (
        f"Measured in {study['reference']}: hydrostatics leaves out {percent(momentum)} of the "
        f"liquid’s momentum, and a pressure of {percent(dynamic)} of what hydrostatics keeps (rms)."
    )


def _errors(study: Mapping[str, Any]) -> Section:
    reference, rows = study["reference"], []
    for name, row in study["models"].items():
        errors, below = row.get("error") or {}, row.get("below_reference_error") or []
        cells = [_cell(key, errors.get(key), key in below) for key in _COLUMNS]
        if name == reference:
            cells = ["reference"] + [""] * (len(_COLUMNS) - 1)
        elif row.get("failure"):
            cells = ["failed"] + [""] * (len(_COLUMNS) - 1)
        rows.append([name, number(row.get("wall_s"), "s"), _times(row.get("speedup")), *cells])
    for key, errors in study["discretisation"].items():
        cells = [_cell(name, errors.get(name), False) for name in _COLUMNS]
        rows.append([f"{reference}, {_own(key, reference)}", "", "", *cells])
    return Section(
        title="Errors and speed",
        tables=[
            Table(
                head=["Model", "wall time", "speed-up", *_COLUMNS.values()],
                rows=rows,
                note="Errors are relative to the reference’s own figure, but for the phase. "
                "The rows under the models are the reference itself, less resolved: its own "
                "discretisation error. ≈ marks an error below it, where no difference between "
                "the models can be told.",
            )
        ],
    )


def _own(key: str, reference: str) -> str:
    grid = "half the cells" if reference == "openfoam" else "half the triangles"
    return {"coarser_grid": grid, "doubled_step": "doubled step"}.get(key, key)


def _cell(name: str, value: float | None, below: bool) -> str:
    text = number(value, "°", 2) if name.endswith("_deg") else percent(value)
    return f"≈ {text}" if below else text


def _times(value: float | None) -> str:
    return "–" if value is None else f"{number(value)} ×"


def _curves(runs: Sequence[RunFiles], study: Mapping[str, Any]) -> list[Section]:
    moving = [run for run in runs if len(run.results.time) > 1]
    if not moving:
        return []
    axis = int(np.argmax(np.ptp(moving[0].results.tank_displacement, axis=0)))
    name = "xyz"[axis]
    middle = [run.results.liquid_cg[:, axis].mean() for run in moving]
    cg = [1e3 * (r.results.liquid_cg[:, axis] - m) for r, m in zip(moving, middle, strict=True)]
    force = [run.results.force[:, axis] for run in moving]
    flowing = [run for run in moving if run.has_flow]
    pressure = [pressure_rms(run)[0] / 1e3 for run in flowing]
    datum = [run.results.datum_pressure / 1e3 for run in moving]
    pictures = [
        overlay(moving, cg, f"CG, {name} (mm)", "Liquid’s centre of gravity in the tank."),
        overlay(moving, force, f"force, {name} (N)", "Force on tank and diaphragm."),
        overlay(moving, datum, "datum pressure (kPa)", "Pressure at the tank’s centre."),
    ]
    if flowing:
        caption = "Pressure beyond hydrostatics, over the diaphragm."
        pictures.append(overlay(flowing, pressure, "p*, rms (kPa)", caption))
    return [Section(title="Over time", pictures=[*pictures, *_speed(study)])]


def _speed(study: Mapping[str, Any]) -> list[Picture]:
    points = []
    for name, row in study["models"].items():
        own = [worst({"error": errors}) for errors in study["discretisation"].values()]
        error = worst(row)
        if name == study["reference"]:
            error = max((one for one in own if one), key=lambda one: one[1], default=None)
        if error is not None and error[1] > 0.0 and row.get("wall_s"):
            points.append((name, float(row["wall_s"]), error[1]))
    return [speed_figure(points)] if points else []


def _reference(runs: Sequence[RunFiles]) -> list[Section]:
    """What the run with a flow says of itself: pressures, iterations, mesh, wall time by part."""
    return [
        replace(section, title=f"{section.title} ({run.model})")
        for run in runs
        if run.has_flow and len(run.results.time) > 1
        for section in (pressure_section(run), quality_section(run))
    ]


def _shapes(runs: Sequence[RunFiles]) -> Section:
    seen = [run for run in runs if len(run.results.time)]
    return Section(
        title="Diaphragm",
        text="Cut in the plane of shaking, all models at the same instants.",
        pictures=overlaid_sections(seen) if seen else [],
        columns=4,
        scale=model_legend([run.model for run in seen]) if seen else None,
    )


def _scene(run: RunFiles) -> Section:
    return Section(title="Scene", tables=scene_tables(run), source=run.results.scene_toml)
