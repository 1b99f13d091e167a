"""The diaphragm at some instants: in space, and cut through the tank's axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from coupling.ports import Array
from coupling.report.figures import model_line
from coupling.report.files import RunFiles
from coupling.report.page import Picture
from coupling.report.picture import draw_tank, period_rows, pressure_colours
from coupling.report.section_cut import cut, horizontal
from coupling.report.style import BLUE, GREY, INK, new_figure, png, svg

COUNT = 4


def views(run: RunFiles) -> tuple[list[Picture], Picture]:
    """Pictures in space at instants of the last period, and the scale of their colours."""
    results = run.results
    rows = period_rows(results, COUNT)
    colours = pressure_colours(results, rows)
    pictures = []
    for row in rows:
        figure = Figure(figsize=(2.4, 2.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
        draw_tank(axes, results, row, colours)
        text = f"t = {results.time[row]:.3f} s"
        pictures.append(
            Picture(source=png(figure), caption=text, alt=f"Diaphragm in the tank at {text}")
        )
    figure = new_figure(height=0.62)
    axis = figure.subplots()
    bar = figure.colorbar(colours.mappable, cax=axis, orientation="horizontal")
    bar.outline.set_visible(False)
    bar.set_label(colours.label)
    return pictures, Picture(source=svg(figure), caption="", alt=f"Scale: {colours.label}")


def sections(run: RunFiles) -> list[Picture]:
    """The same instants, cut in the plane of shaking, with the liquid filled."""
    results = run.results
    along = horizontal(np.ptp(results.tank_displacement, axis=0))
    pictures = []
    for row in period_rows(results, COUNT):
        figure = Figure(figsize=(2.4, 2.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        _shell(axes, run.scene.tank.radius)
        for curve in cut(results.position[row], results.triangles, along):
            axes.fill(*_liquid(curve, run.scene.tank.radius).T, color=BLUE, alpha=0.16, linewidth=0)
            axes.plot(*curve.T, color=INK, linewidth=1.6)
        cg = results.liquid_cg[row]
        axes.plot(cg @ along, cg[2], "+", color=BLUE, markersize=9, markeredgewidth=1.6)
        text = f"t = {results.time[row]:.3f} s"
        pictures.append(Picture(source=svg(figure), caption=text, alt=f"Section at {text}"))
    return pictures


def overlaid_sections(runs: Sequence[RunFiles]) -> list[Picture]:
    """All models' sections at the instants of the first run of ``runs``."""
    first = runs[0].results
    along = horizontal(np.ptp(first.tank_displacement, axis=0))
    pictures = []
    for row in period_rows(first, COUNT):
        instant = float(first.time[row])
        figure = Figure(figsize=(2.4, 2.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        _shell(axes, runs[0].scene.tank.radius)
        for run in runs:
            near = int(np.argmin(np.abs(run.results.time - instant)))
            for curve in cut(run.results.position[near], run.results.triangles, along):
                axes.plot(*curve.T, linewidth=1.5, **model_line(run.label))
        text = f"t = {instant:.3f} s"
        pictures.append(Picture(source=svg(figure), caption=text, alt=f"Sections at {text}"))
    return pictures


def _shell(axes: Any, radius: float) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    axes.plot(radius * np.cos(angle), radius * np.sin(angle), color=GREY, linewidth=1.0)
    axes.set(
        aspect="equal", xlim=(-1.04 * radius, 1.04 * radius), ylim=(-1.04 * radius, 1.04 * radius)
    )
    axes.set_axis_off()


def _liquid(curve: Array, radius: float) -> Array:
    """The curve closed along the shell below it, from its right end round to its left."""
    first, last = np.arctan2(curve[0, 1], curve[0, 0]), np.arctan2(curve[-1, 1], curve[-1, 0])
    if first > 0.5 * np.pi:
        first -= 2.0 * np.pi
    angle = np.linspace(last, first, 91)
    return np.vstack([curve, radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)])
