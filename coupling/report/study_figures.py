"""Figures of a study: errors with their bars, and speed against error."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, NullFormatter

from coupling.metrics.comparison import Errors
from coupling.report.page import Picture
from coupling.report.style import GREY, INK, LIGHT, look_of, new_figure, svg

Point = Mapping[str, Any]

COLUMNS = {
    "shape_rms": "shape (rms/R)",
    "cg_amplitude": "CG amplitude",
    "cg_phase_deg": "CG phase",
    "force_amplitude": "force amplitude",
    "pressure_rms": "pressure (rms)",
}
RESOLUTIONS = {
    "as_run": "as run",
    "coarser_grid": "coarser grid",
    "doubled_step": "doubled step",
    "halved_step": "halved step",
    "doubled_stiffness": "doubled stiffness",
    "coarsest_grid": "coarsest grid",
    "coarser_diaphragm": "coarser diaphragm",
    "looser_coupling": "looser coupling",
    "looser_diaphragm": "looser diaphragm",
    "lower_degree": "lower degree",
}
SOURCES = {  # of error, as a table says them
    "coarsest_grid": "a quarter of the cells",
    "coarser_diaphragm": "half the diaphragm’s triangles",
    "looser_coupling": "ten times the coupling’s tolerance",
    "looser_diaphragm": "ten times the diaphragm’s tolerance",
    "lower_degree": "polynomials of two degrees less",
    "half_fold_damping": "half the damping of folds below the grid",
    "other_rim": "the rim clamped where it is hinged, or hinged",
    "friction": "friction of 0.3 on the shell and on itself",
    "compliant": "the rubber’s own compliance",
    "inextensible": "no stretching",
}
_MARKERS = {
    "as_run": "o",
    "coarser_grid": "s",
    "doubled_step": "^",
    "halved_step": "v",
    "doubled_stiffness": "D",
    "coarsest_grid": "p",
    "coarser_diaphragm": "P",
    "looser_coupling": "X",
    "looser_diaphragm": "*",
    "lower_degree": "d",
}


def errors_figure(errors: Mapping[str, Errors], bars: Errors) -> Picture:
    """Errors of each row by figure, in its colour, with the reference's own error as bars."""
    figure = new_figure(height=2.7)
    axes, degrees = figure.subplots(1, 2, width_ratios=(4, 1))
    _bars(axes, [name for name in COLUMNS if not name.endswith("_deg")], errors, bars, 100.0)
    _bars(degrees, ["cg_phase_deg"], errors, bars, 1.0)
    axes.set_ylabel("error (%)")
    degrees.set_ylabel("error (°)")
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper left", ncols=3, columnspacing=1.2)
    text = (
        "Errors against the reference. The thin bars are the reference’s own error, estimated; "
        "those that leave the picture go on."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _bars(
    axes: Any, names: Sequence[str], errors: Mapping[str, Errors], bars: Errors, scale: float
) -> None:
    width, highest = 0.8 / max(len(errors), 1), 0.0
    for index, (row, values) in enumerate(errors.items()):
        known = [(k, name) for k, name in enumerate(names) if values.get(name) is not None]
        places = np.array([k for k, _ in known]) + (index + 0.5) * width - 0.4
        heights = scale * np.array([float(values[name] or 0.0) for _, name in known])
        spread = scale * np.array([float(bars.get(name) or 0.0) for _, name in known])
        axes.bar(places, heights, 0.92 * width, color=look_of(row)[0], label=row)
        if spread.any():
            reach = [np.minimum(spread, heights), spread]
            axes.errorbar(
                places, heights, reach, fmt="none", ecolor=INK, elinewidth=0.8, capsize=1.6
            )
        highest = max(highest, heights.max(initial=0.0))
    labels = [COLUMNS[name].partition(" (")[0].replace(" amplitude", "\nampl.") for name in names]
    axes.set_xticks(range(len(names)), labels)
    axes.set_ylim(0.0, 1.3 * highest if highest > 0.0 else 1.0)
    axes.grid(visible=False, axis="x")


def front_figure(points: Sequence[Point], reference: str, name: str, bar: float | None) -> Picture:
    """Error ``name`` against wall time of every point of a study, and the front of the best.

    The ``reference`` as run has no error against itself: it stands, hollow, at its own (``bar``).
    """
    figure = new_figure(height=3.4)
    axes = figure.subplots()
    seen = [point for point in points if point["wall_s"] and point["error"].get(name)]
    best = [p for p in points if (p["model"], p["resolution"]) == (reference, "as_run")]
    if bar:
        axes.axhspan(1e-9, 100.0 * bar, color=LIGHT, alpha=0.6, linewidth=0)
    front = sorted(
        (point["wall_s"], 100.0 * point["error"][name])
        for point in seen
        if name in point["on_front"]
    )
    if front:
        axes.plot(*zip(*front, strict=True), color=INK, linewidth=1.0, zorder=1)
    for point in seen:
        _plot_point(axes, point, 100.0 * point["error"][name], hollow=False)
    for point in best if bar else []:
        _plot_point(axes, point, 100.0 * (bar or 0.0), hollow=True)
    heights = [100.0 * point["error"][name] for point in seen]
    _logarithmic(axes, [*heights, 100.0 * bar] if bar else heights)
    axes.set(xlabel="wall time (s)", ylabel=f"error, {COLUMNS[name]} (%)")
    markers = [
        Line2D([], [], marker=marker, linestyle="", color=GREY, label=RESOLUTIONS[key])
        for key, marker in _MARKERS.items()
        if any(point["resolution"] == key for point in (*seen, *best))
    ]
    figure.legend(handles=markers, loc="outside upper left", ncols=2)
    text = (
        f"Speed against error in {COLUMNS[name]}: lower and further left is better; the line joins "
        "those that no other beats. Grey: within the reference’s own error, where no difference "
        f"can be resolved; {reference} as run stands at its edge."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _plot_point(axes: Any, point: Point, height: float, *, hollow: bool) -> None:
    colour = look_of(point["model"])[0]
    axes.loglog(
        point["wall_s"],
        height,
        _MARKERS.get(point["resolution"], "o"),
        color=colour,
        markerfacecolor="white" if hollow else colour,
        markersize=7 if point["resolution"] == "as_run" else 5,
    )
    if point["resolution"] == "as_run":
        axes.annotate(
            point["model"],
            (point["wall_s"], height),
            xytext=(5, 4),
            textcoords="offset points",
            color=colour,
            fontsize=8,
        )


def _logarithmic(axes: Any, heights: Sequence[float]) -> None:
    axes.set(xscale="log", yscale="log")
    axes.set_ylim(0.5 * min(heights), 2.0 * max(heights))
    low, high = axes.get_xlim()
    axes.set_xlim(low / 1.3, high * 2.0)  # room for the last name
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(FuncFormatter(_plain))
        low, high = axis.get_view_interval()
        if high > 10.0 * low:
            axis.set_minor_formatter(NullFormatter())
        else:
            axis.set_minor_formatter(FuncFormatter(_plain))


def _plain(value: float, _: int) -> str:
    return f"{value:g}"
