"""Liquid drawn from the tank: pressure drop, folds and rubs against the fill fraction."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.metrics.expulsion import covering_gap, work_of
from coupling.ports import Array
from coupling.report.files import RunFiles
from coupling.report.page import Picture, Section, Table, number, percent
from coupling.report.style import BLUE, GREY, INK, ORANGE, legend_above, new_figure, svg, thinned
from coupling.store.stored_rows import blocks

_NOTE = (
    "The drop is the gas’s pressure over the liquid’s, beyond the head of a level liquid without a "
    "diaphragm; below 0 the diaphragm presses on the liquid, as its own weight does. The outlet "
    "is the shell’s lower pole. What damping takes falls with the rate of drawing, but for what "
    "is lost as folds snap."
)
_RELAXED = (
    "The folds are below the grid and relaxed: what the rubber takes to fold is not in the drop, "
    "which is that of its weight and of the bending that the grid shows."
)


def expulsion_section(run: RunFiles) -> Section | None:
    """The table and the curves over the fill fraction; None of a run from which none is drawn."""
    found = run.summary.get("expulsion")
    if found is None:
        return None
    pictures = [_pressure(run), _folds(run)]
    rubbed = _rubs(run)
    return Section(
        title="Expulsion",
        text=_RELAXED if run.summary["folds"]["below_grid"] else "",
        tables=[expulsion_table(run, found)],
        pictures=pictures if rubbed is None else [*pictures, rubbed],
    )


def expulsion_table(run: RunFiles, found: dict[str, Any]) -> Table:
    """Return a table of a summary's ``expulsion``."""
    residual = found["residual_volume_m3"]
    covered = "not down to this fill fraction"
    if residual is not None:
        covered = f"at a fill fraction of {number(found['outlet_covered_at_fill'])}"
    rows = [
        ["Fill fraction, start", number(run.scene.liquid.fill_fraction)],
        ["Fill fraction, end", number(found["fill_fraction_end"])],
        ["Pressure drop, largest", number(found["pressure_drop_max_Pa"], "Pa")],
        ["… at a fill fraction of", number(found["pressure_drop_max_at_fill"])],
        ["Pressure drop, mean over the drawn volume", number(found["pressure_drop_mean_Pa"], "Pa")],
        ["… corrected for the grid’s chords by, rms", _pascal(found, "chords")],
        ["… of it taken by fold_damping and slack_drag", _pascal(found, "damping")],
        ["Work of the drop", number(found["work_J"], "J")],
        ["Liquid at the outlet at the end, above the gas", _pascal_of(found)],
        ["Outlet covered", covered],
        ["Liquid left then", number(None if residual is None else 1e3 * residual, "l")],
        ["Folded over most at a fill fraction of", number(found["folded_area_max_at_fill"])],
        ["Most folds at a fill fraction of", number(found["folds_max_at_fill"])],
        ["Liquid’s inertia over its weight, u²/(gR)", number(found["inertia_ratio"])],
        ["Largest kinetic energy of the diaphragm", _share(found)],
    ]
    shown = [row for row in rows if row[1] != "–"]
    return Table(head=["Expulsion", ""], rows=shown, note=_NOTE)


def _pascal(found: dict[str, Any], name: str) -> str:
    return number(found[f"pressure_drop_{name}_Pa"], "Pa", 2)


def _pascal_of(found: dict[str, Any]) -> str:
    return number(found["outlet_pressure_end_Pa"], "Pa")


def _share(found: dict[str, Any]) -> str:
    """The kinetic energy, and its share of the work of the drop."""
    energy, work = found["sheet_kinetic_energy_max_J"], abs(found["work_J"])
    text = number(energy, "J", 2)
    return f"{text}, {percent(energy / work)} of the work" if work else text


def _fill(run: RunFiles) -> Array:
    return np.asarray(run.results.steps.volume / run.scene.tank.volume)


def _pressure(run: RunFiles) -> Picture:
    """Pressure drop, and its work, against the fill fraction."""
    steps, fill = run.results.steps, _fill(run)
    drop, chords = steps.metrics["pressure_drop"], steps.metrics["pressure_drop_chords"]
    figure = new_figure(height=3.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    upper.plot(*thinned(fill, drop), color=INK, label="pressure drop")
    upper.plot(*thinned(fill, drop - chords), ":", color=GREY, label="without the chords’ part")
    upper.set_ylabel("drop (Pa)")
    legend_above(upper)
    lower.plot(*thinned(fill, work_of(steps)), color=ORANGE)
    lower.set_ylabel("work (J)")
    _finish(lower)
    figure.align_ylabels()
    text = (
        "Pressure drop across the diaphragm against the fill fraction, from full on the left; the "
        "dotted curve lacks the correction for the chords by which the grid cuts the shell off. "
        "Below: the drop’s work."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _folds(run: RunFiles) -> Picture:
    """Area folded over, number of folds and the outlet's distance, against the fill fraction."""
    steps, fill = run.results.steps, _fill(run)
    number_of = steps.metrics.get("fold_number")
    figure = new_figure(height=3.6)
    axes = figure.subplots(2 if number_of is None else 3, 1, sharex=True)
    axes[0].plot(*thinned(fill, 1e4 * steps.metrics["folded_area"]), color=INK)
    axes[0].set_ylabel("folded (cm²)")
    if number_of is not None:
        axes[1].plot(*thinned(fill, number_of), color=BLUE)
        axes[1].set_ylabel("folds")
    axes[-1].plot(*thinned(fill, 1e3 * steps.metrics["outlet_gap"]), color=INK)
    axes[-1].axhline(1e3 * covering_gap(run.scene), color=GREY, linewidth=1.0, linestyle="--")
    axes[-1].set_ylabel("outlet (mm)")
    axes[-1].set_ylim(bottom=0.0)
    _finish(axes[-1])
    figure.align_ylabels()
    text = (
        "Area folded over, number of folds where the grid resolves them, and the diaphragm’s "
        "distance from the outlet, which it covers below the dashed line."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _rubs(run: RunFiles) -> Picture | None:
    """Largest slip work on the shell and on itself; None where nothing slid."""
    results = run.results
    fill = results.volume / run.scene.tank.volume
    curves = {
        name: np.concatenate([work.max(axis=1) for (work,) in blocks(rows)])
        for name, rows in (("shell", results.shell_work), ("itself", results.self_work))
    }
    if not max(float(curve.max()) for curve in curves.values()) > 0.0:
        return None
    figure = new_figure()
    axes = figure.subplots()
    for (name, curve), colour, line in zip(curves.items(), (INK, BLUE), ("-", "--"), strict=True):
        axes.plot(*thinned(fill, curve), line, color=colour, label=f"on {name}")
    axes.set_ylabel("slip work (J/m²)")
    legend_above(axes)
    _finish(axes)
    text = "Largest slip work per area so far, on the shell and on itself, at the instants."
    return Picture(source=svg(figure), caption=text, alt=text)


def _finish(axes: Any) -> None:
    axes.set_xlabel("fill fraction")
    axes.set_xlim(1.0, 0.0)
