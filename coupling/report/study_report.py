"""The report of a study: all models over each other, and their errors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from coupling.report.figures import model_legend, overlay
from coupling.report.files import RunFiles, pressure_rms, read_run
from coupling.report.instants import overlaid_sections
from coupling.report.page import Page, Section, percent
from coupling.report.record_section import study_sections
from coupling.report.run_report import pressure_section, provenance, quality_section
from coupling.report.scene_tables import scene_tables
from coupling.report.study_figures import errors_figure, front_figure
from coupling.report.study_tables import (
    checks_table,
    errors_table,
    front_table,
    ratios_table,
    sources_table,
)
from coupling.report.terms import TERMS
from coupling.report.viewer import study_view

_PARTS = {  # what a source of error is a run with something else of
    "coarser_grid": "grid", "doubled_step": "time step", "halved_step": "time step",
    "doubled_stiffness": "stiffness in place of inextensibility",
    "coarser_diaphragm": "diaphragm’s grid", "looser_coupling": "coupling tolerance",
    "looser_diaphragm": "diaphragm’s tolerance", "lower_degree": "degree of the polynomials",
}  # fmt: skip
_RANGES = (
    "A record has no amplitude: here and below, CG and force amplitude are half the peak-to-peak "
    "ranges, which hang on one instant each. The bands of frequency above say more."
)
_CURVELESS = ("compliant", "inextensible")  # lies on the curve of the model it changes


def study_page(folder: Path, study: Mapping[str, Any]) -> Page:
    """Page of a study from ``study.json`` and the folders of its runs."""
    rows = study["models"]
    runs = [
        replace(read_run(folder / name), row=name)
        for name, row in rows.items()
        if row["status"] == "completed" and (folder / name / "results.h5").is_file()
    ]
    runs.sort(key=lambda run: run.label != study["reference"])  # the others lie on top of it
    failed = [f"{name}: {row['failure']}" for name, row in rows.items() if row.get("failure")]
    sections = [
        *_by_record(study), _errors(study), *_sources(study), *_ratios(study), *_speed(study)
    ]  # fmt: skip
    if runs:
        drawn = [run for run in runs if run.label not in _CURVELESS]
        sections += [*_curves(drawn), _shapes(drawn), *study_view(drawn, study)]
        sections += [*_reference(drawn), _scene(runs[0])]
    sections += [*_checks(study), TERMS]
    title = runs[0].scene.title if runs else ""
    return Page(
        title=f"{title or folder.resolve().name}: fluid models compared",
        subtitle=f"{', '.join(rows)} · errors against {study['reference'] or 'nothing'}",
        verdict=_record_verdict(study) or study.get("verdict") or study["advice"],
        explanation=_explained(study),
        alarm="; ".join(failed),
        sections=sections,
        footer=provenance(runs[0]) if runs else "",
    )


def _explained(study: Mapping[str, Any]) -> str:
    advised = study["advice"] if study.get("verdict") or _record_verdict(study) else ""
    return " ".join(
        text
        for text in (advised, _largest_source(study), _measured(study), _periodic(study))
        if text
    )


def _record_verdict(study: Mapping[str, Any]) -> str:
    """Whether hydrostatics was enough, by band of frequency; empty of a motion with a period."""
    return str((study.get("record") or {}).get("verdict") or "")


def _by_record(study: Mapping[str, Any]) -> list[Section]:
    record = study.get("record")
    return [] if record is None else study_sections(record, study["reference"])


def _periodic(study: Mapping[str, Any]) -> str:
    """How far the reference is from a periodic motion, where it is not one; else empty."""
    row = study["models"].get(study["reference"]) or {}
    if not row.get("transient") or study.get("record"):
        return ""
    drift = row.get("drift")
    if drift is None:
        return (
            "The run is shorter than two periods: amplitudes and phases are those of a transient."
        )
    return (
        f"The motion is not periodic yet: from the last period but one to the last the CG’s "
        f"harmonic changes by {percent(drift)}, so that amplitudes and phases are those of a "
        "transient; a longer time.duration settles that."
    )


def _largest_source(study: Mapping[str, Any]) -> str:
    """Which source the reference's error in the CG's amplitude comes from most; empty without."""
    known = [
        (one["share"].get("cg_amplitude"), one["source"])
        for one in study.get("sources") or []
        if one["kind"] == "numerical"
    ]
    found = [(share, source) for share, source in known if share is not None]
    if len(found) < 2:
        return ""
    share, source = max(found)
    figure = "the CG’s peak-to-peak range" if study.get("record") else "the CG amplitude"
    return (
        f"Most of what {study['reference']} itself errs by in {figure} comes from its "
        f"{_PARTS.get(source, source.replace('_', ' '))}: {percent(share)}."
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
    reference, bars = study["reference"], study.get("uncertainty") or {}
    errors = {
        name: row["error"]
        for name, row in study["models"].items()
        if name != reference and row.get("error")
    }
    pictures = [errors_figure(errors, bars)] if errors else []
    return Section(
        title="Errors",
        text=_RANGES if study.get("record") else "",
        tables=[errors_table(study)],
        pictures=pictures,
        columns=1,
    )


def _sources(study: Mapping[str, Any]) -> list[Section]:
    table = sources_table(study)
    return [] if table is None else [Section(title="Where the error comes from", tables=[table])]


def _checks(study: Mapping[str, Any]) -> list[Section]:
    table = checks_table(study)
    return [] if table is None else [Section(title="Checks against theory", tables=[table])]


def _ratios(study: Mapping[str, Any]) -> list[Section]:
    table = ratios_table(study)
    return [] if table is None else [Section(title="Bernoulli’s terms", tables=[table])]


def _speed(study: Mapping[str, Any]) -> list[Section]:
    """Empty for a study without points, of an earlier version."""
    points, bars = study.get("points") or [], study.get("uncertainty") or {}
    shown = [
        front_figure(points, study["reference"], name, bars.get(name))
        for name in ("cg_amplitude", "shape_rms")
        if any(point["error"].get(name) for point in points)
    ]
    if not points:
        return []
    return [Section(title="Speed against error", tables=[front_table(study)], pictures=shown)]


def _curves(runs: Sequence[RunFiles]) -> list[Section]:
    moving = [run for run in runs if len(run.results.time) > 1]
    if not moving:
        return []
    series = [run.results.steps for run in moving]
    axis = int(np.argmax(np.ptp(series[0].tank_displacement, axis=0)))
    name = "xyz"[axis]
    way = [one.liquid_cg[:, axis] - one.liquid_cg[:, axis].mean() for one in series]
    cg = [(one.time, 1e3 * moved) for one, moved in zip(series, way, strict=True)]
    force = [(one.time, one.force[:, axis]) for one in series]
    flowing = [run for run in moving if run.has_flow]
    pressure = [(run.results.time, pressure_rms(run)[0] / 1e3) for run in flowing]
    datum = [(one.time, one.datum_pressure / 1e3) for one in series]
    pictures = [
        overlay(moving, cg, f"CG, {name} (mm)", "Liquid’s centre of gravity in the tank."),
        overlay(moving, force, f"force, {name} (N)", "Force on tank and diaphragm."),
        overlay(moving, datum, "datum pressure (kPa)", "Pressure at the tank’s centre."),
    ]
    if flowing:
        caption = "Pressure beyond hydrostatics, over the diaphragm."
        pictures.append(overlay(flowing, pressure, "p*, rms (kPa)", caption))
    return [Section(title="Over time", pictures=pictures)]


def _reference(runs: Sequence[RunFiles]) -> list[Section]:
    """What the run with a flow says of itself: pressures, iterations, mesh, wall time by part."""
    return [
        replace(section, title=f"{section.title} ({run.label})")
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
        scale=model_legend([run.label for run in seen]) if seen else None,
    )


def _scene(run: RunFiles) -> Section:
    return Section(title="Scene", tables=scene_tables(run), source=run.results.scene_toml)
