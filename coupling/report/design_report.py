"""The report of a design curve: the least thickness over the radius, its brackets, what decided."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.report.design_figures import thickness_figure, value_figure, worst_instants
from coupling.report.page import Page, Section, Table, number


def design_page(folder: Path, content: Mapping[str, Any]) -> Page:
    """Page of a design curve from what its ``design.json`` holds, and from its runs."""
    rows, limit = content["rows"], content["limit"]
    runs = [run for row in rows for run in row["runs"]]
    failed = [run for run in runs if run["failure"]]
    verdict, explanation = _verdict(content)
    sections = [_curve(rows)]
    if runs:
        pictures = [thickness_figure(rows), value_figure(rows, limit, content["criterion"])]
        sections.append(Section(title="Thickness and criterion", pictures=pictures))
    shown = [
        picture
        for row in rows
        for picture in worst_instants(folder, row, content["criterion"], content["model"])
    ]
    if shown:
        text = (
            "The instant, of those written out, at which the criterion's figure is largest or "
            "grows fastest. The colour is the pressure, each picture's own scale."
        )
        sections.append(Section(title="At the ends of the brackets", text=text, pictures=shown))
    sections += [_meaning(content), _runs(runs)]
    return Page(
        title=f"{content['title'] or folder.resolve().name}: the least thickness",
        subtitle=f"{content['criterion']} below {limit:g} · {content['model']} · "
        f"{len(runs)} runs at {len(rows)} radii",
        verdict=verdict,
        explanation=explanation,
        alarm=_alarm(rows, len(failed)),
        sections=sections,
        footer="Figures: design.csv, runs.csv and design.json; runs: points/<point>/<model>.",
    )


def _verdict(content: Mapping[str, Any]) -> tuple[str, str]:
    closed = [row for row in content["rows"] if row["status"] == "bracketed"]
    said = (
        f"Brackets are at most {100.0 * content['bracket_width']:g}\u202f% wide. What the runs' "
        "own errors make of the value moves them beyond that."
    )
    if not closed:
        return "At no radius was a least thickness bracketed.", said
    first, last = closed[0], closed[-1]
    ends = [
        f"{number(1e3 * row['enough_m'], 'mm')} at R = {number(row['radius_m'], 'm')}"
        for row in ((first, last) if len(closed) > 1 else (first,))
    ]
    return f"Enough: {', '.join(ends)}.", said


def _alarm(rows: Sequence[Mapping[str, Any]], failed: int) -> str:
    wavy = [number(row["radius_m"], "m") for row in rows if not row["monotonic"]]
    said = [f"Not monotonic in the thickness at R = {', '.join(wavy)}: see below."] if wavy else []
    said += [f"{failed} runs failed."] if failed else []
    return " ".join(said)


def _curve(rows: Sequence[Mapping[str, Any]]) -> Section:
    lines = [
        [
            number(row["radius_m"]),
            row["status"],
            number(_milli(row["too_thin_m"])),
            number(_milli(row["enough_m"])),
            number(row["mass_kg"]),
            number(row["wavelength_over_radius"]),
            number(row["thickness_over_radius"]),
        ]
        for row in rows
    ]
    heads = ["R (m)", "", "too thin (mm)", "enough (mm)", "mass (kg)", "λ/R", "t/R"]
    note = (
        "Mass of the diaphragm, λ/R and t/R are those of the thickness that is enough. "
        "λ = 2π (κ/(ρ g))^(1/4) is the elasto-gravity wavelength, κ the bending stiffness."
    )
    remarks = [[number(row["radius_m"]), f"{one}."] for row in rows for one in row["remarks"]]
    tables = [Table(head=heads, rows=lines, note=note)]
    if remarks:
        tables.append(Table(head=["R (m)", "Remark"], rows=remarks, numbers=False))
    return Section(title="The curve", tables=tables)


def _milli(value: float | None) -> float | None:
    return None if value is None else 1e3 * value


def _meaning(content: Mapping[str, Any]) -> Section:
    searched = "; ".join(
        f"R = {number(one['radius_m'], 'm')}: {number(1e3 * one['least_m'])} to "
        f"{number(1e3 * one['largest_m'], 'mm')}"
        for one in content["searched"]
    )
    rows = [
        ["Criterion", f"{content['figure']}, below {content['limit']:g}"],
        ["What it leaves open", content["reservation"]],
        ["The same at all radii", content["same"]],
        ["Searched", searched],
        [
            "How",
            f"{content['scan']} thicknesses from end to end, spaced geometrically; then the "
            "bracket is halved in the logarithm of the thickness. A change of the verdict between "
            "two of these that changes back is not seen.",
        ],
    ]
    return Section(title="What is meant", tables=[Table(rows=rows, numbers=False)])


def _runs(runs: Sequence[Mapping[str, Any]]) -> Section:
    words = {True: "keeps the limit", False: "misses it", None: "failed"}
    lines = [
        [
            number(run["radius_m"]),
            number(1e3 * run["thickness_m"], digits=4),
            number(run["mass_kg"]),
            number(run["wavelength_over_radius"]),
            number(run["value"]),
            words[run["kept"]],
            run["failure"] or "–",
        ]
        for run in runs
    ]
    heads = ["R (m)", "thickness (mm)", "mass (kg)", "λ/R", "value", "", "reason"]
    return Section(title="All runs", tables=[Table(head=heads, rows=lines)])
