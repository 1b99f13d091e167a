"""The report of a sweep: where the cheaper models are good enough, in maps and a table."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coupling.metrics.advice import LEVELS
from coupling.report.page import Page, Picture, Section, Table, number, percent
from coupling.report.sweep_figures import error_curves, error_map, figure_curves
from coupling.report.sweep_grid import FREQUENCY, Grid, label

_WORDS = {
    "cg_amplitude": "CG amplitude",
    "shape_rms": "shape (rms/R)",
    "force_amplitude": "force amplitude",
}
_DRAWN = ("cg_amplitude", "shape_rms")


def sweep_page(folder: Path, content: Mapping[str, Any]) -> Page:
    """Page of a sweep from what its ``sweep.json`` holds."""
    grid = Grid(content=content)
    rows, reference = grid.rows, content["reference"]
    failed = [row for row in rows if row["failure"]]
    sections = [_limits(grid)] if grid.lesser else []
    if grid.numeric and rows and grid.lesser:
        sections += _figures(grid)
    if failed:
        sections.append(_failures(grid, failed))
    if content.get("wanted"):
        sections.append(_wanted(grid))
    if grid.lesser or not content.get("wanted"):
        sections.append(_points(grid))
    verdict, explanation = _verdict(grid)
    done = f"{len(rows)} of {content['points']} points"
    shown = f"errors against {reference}" if reference else f"figures of {content['models'][0]}"
    return Page(
        title=f"{content['title'] or folder.resolve().name}: a sweep",
        subtitle=f"{' × '.join(map(label, grid.keys))} · {done} · {shown}",
        verdict=verdict,
        explanation=explanation,
        alarm=f"{len(failed)} of {len(rows)} points have a model that failed." if failed else "",
        sections=sections,
        footer=f"Figures: sweep.csv and sweep.json; runs: points/<point>/<model>. Models: "
        f"{', '.join(content['models'])}.",
    )


def _verdict(grid: Grid) -> tuple[str, str]:
    reference = grid.content["reference"]
    if reference is None and grid.rows:
        completed = sum(row["failure"] is None for row in grid.rows)
        return f"{completed} of {len(grid.rows)} runs completed.", "One model: no errors of models."
    if not grid.lesser or not grid.rows:
        return "There is nothing to compare yet.", "It takes points with two models."
    model, level = grid.lesser[0], LEVELS[1]
    error = grid.error(model, "cg_amplitude")
    known = np.isfinite(error)
    within = int((error[known] <= level).sum())
    headline = (
        f"{model.capitalize()} stays within {100.0 * level:g}\u202f% of {reference} in CG "
        f"amplitude at {within} of {int(known.sum())} points."
    )
    limit = _up_to(grid, error, level)
    explanation = (
        f"Every point up to f/f₁ = {number(limit)} does."
        if limit is not None
        else "No frequency is known up to which every point does."
    )
    return headline, explanation


def _up_to(grid: Grid, error: Any, level: float) -> float | None:
    """Largest f/f1 up to which every known error is within ``level``; None where there is none."""
    ratio = grid.number("frequency_ratio")
    known = np.isfinite(error) & np.isfinite(ratio)
    beyond = ratio[known & ~(error <= level)]
    good = ratio[known & (error <= level)]
    good = good[good < beyond.min(initial=np.inf)]
    return float(good.max()) if good.size else None


def _limits(grid: Grid) -> Section:
    rows = []
    for model in grid.lesser:
        for name, word in _WORDS.items():
            error = grid.error(model, name)
            known = int(np.isfinite(error).sum())
            cells = []
            for level in LEVELS:
                limit = _up_to(grid, error, level)
                cells.append(f"{int((error <= level).sum())} of {known}; {number(limit)}")
            rows.append([f"{model}: {word}", *cells])
    return Section(
        title="How far the cheaper models reach",
        tables=[
            Table(
                head=["Error in", *(f"within {100.0 * level:g}\u202f%" for level in LEVELS)],
                rows=rows,
                note="How many points are within, and the largest f/f₁ up to which all points "
                "are. Definitions as in a study: relative to the reference’s own figure.",
            )
        ],
    )


def _figures(grid: Grid) -> list[Section]:
    ratios = FREQUENCY in grid.keys
    sections = []
    if len(grid.keys) == 2:
        for model in grid.lesser:
            pictures = [
                error_map(grid, model, name, _WORDS[name], ratio=ratio)
                for ratio in (False, True)
                for name in _DRAWN
            ]
            drawn = [picture for picture in pictures if picture is not None]
            sections.append(Section(title=f"Error of {model}", pictures=drawn))
    curves: list[Picture] = []
    for ratio in (False, True) if len(grid.keys) == 1 and ratios else (ratios,):
        curves += [error_curves(grid, name, _WORDS[name], ratio=ratio) for name in _DRAWN]
    return [*sections, Section(title="Error by frequency" if ratios else "Error", pictures=curves)]


def _failures(grid: Grid, failed: list[Mapping[str, Any]]) -> Section:
    rows = [[_place(grid, row), str(row["failure"])] for row in failed]
    return Section(
        title="Failures", tables=[Table(head=["Point", "Reason"], rows=rows, numbers=False)]
    )


def _place(grid: Grid, row: Mapping[str, Any]) -> str:
    return ", ".join(f"{label(key)} {_shown(row['values'][key])}" for key in grid.keys)


def _shown(value: Any) -> str:
    return number(value) if isinstance(value, float) else str(value)


def _wanted(grid: Grid) -> Section:
    """A table with a row a run, and a curve a figure where the only axis is one of numbers."""
    names, rows = grid.content["wanted"], []
    for row in grid.rows:
        values = [_shown(row["values"][key]) for key in grid.keys]
        for model, found in row["models"].items():
            figures = [number(found["wanted"][name]) for name in names]
            rows.append([*values, model, found["status"] or "–", *figures])
    table = Table(head=[*map(label, grid.keys), "model", "status", *names], rows=rows)
    drawn = grid.numeric and len(grid.keys) == 1 and len(rows) > 1
    pictures = [figure_curves(grid, name) for name in names] if drawn else []
    return Section(title="Figures that were asked for", tables=[table], pictures=pictures)


def _points(grid: Grid) -> Section:
    heads = [f"{model}: {word}" for model in grid.lesser for word in _WORDS.values()]
    walls = [f"{model} wall" for model in grid.content["models"]]
    rows = []
    for row in grid.rows:
        errors = [
            percent(row["models"][model]["error"].get(name))
            for model in grid.lesser
            for name in _WORDS
        ]
        seconds = [number(row["models"][model]["wall_s"], "s") for model in grid.content["models"]]
        values = [_shown(row["values"][key]) for key in grid.keys]
        rows.append([*values, number(row["numbers"]["frequency_ratio"]), *errors, *seconds])
    return Section(
        title="All points",
        tables=[Table(head=[*map(label, grid.keys), "f/f₁", *heads, *walls], rows=rows)],
    )
