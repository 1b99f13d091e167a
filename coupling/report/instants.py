"""The diaphragm at some instants: in space, and cut through the tank's axis."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from coupling.ports import Array, Shell
from coupling.report.figures import model_line
from coupling.report.files import RunFiles
from coupling.report.page import Picture
from coupling.report.picture import draw_tank, period_rows, pressure_colours
from coupling.report.section_cut import cut, horizontal
from coupling.report.style import BLUE, GREY, INK, new_figure, png, svg
from coupling.report.window import by_record, drawn

COUNT = 4


def shown_instants(run: RunFiles) -> str:
    """Which instants are shown, in words."""
    if drawn(run.results):
        return "of the whole run"
    if by_record(run.results):
        return "of the second about the one at which the CG is farthest from its mean"
    return "of the last period, or of the second half of a short run"


def views(run: RunFiles) -> tuple[list[Picture], Picture]:
    """Pictures in space at instants of the last period, and the scale of their colours."""
    results = run.results
    rows = period_rows(results, COUNT)
    colours = pressure_colours(results, rows)
    pictures = []
    for row in rows:
        figure = Figure(figsize=(2.4, 2.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
        draw_tank(axes, results, row, colours, run.scene.tank.shell)
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
        _shell(axes, run.scene.tank.shell)
        for curve in cut(results.position[row], results.triangles, along):
            axes.fill(*_liquid(curve, run.scene.tank.shell).T, color=BLUE, alpha=0.16, linewidth=0)
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
        _shell(axes, runs[0].scene.tank.shell)
        for run in runs:
            near = int(np.argmin(np.abs(run.results.time - instant)))
            for curve in cut(run.results.position[near], run.results.triangles, along):
                axes.plot(*curve.T, linewidth=1.5, **model_line(run.label))
        text = f"t = {instant:.3f} s"
        pictures.append(Picture(source=svg(figure), caption=text, alt=f"Sections at {text}"))
    return pictures


def _shell(axes: Any, shell: Shell) -> None:
    """Draw the outline of the ``shell``, all of it in view."""
    right = _meridian(shell, *shell.poles)
    across, (bottom, top) = 1.04 * right[:, 0].max(), shell.poles
    for side in (1.0, -1.0):
        axes.plot(side * right[:, 0], right[:, 1], color=GREY, linewidth=1.0)
    span = max(across, 0.52 * (top - bottom))
    middle = 0.5 * (bottom + top)
    axes.set(aspect="equal", xlim=(-span, span), ylim=(middle - span, middle + span))
    axes.set_axis_off()


def _liquid(curve: Array, shell: Shell) -> Array:
    """The curve (k, 2) closed along the shell below it, from its right end round to its left."""
    ordered = curve if curve[0, 0] < curve[-1, 0] else curve[::-1]
    down = _meridian(shell, ordered[-1, 1], shell.poles[0])
    up = _meridian(shell, shell.poles[0], ordered[0, 1])
    return np.vstack([ordered, down, up * [-1.0, 1.0]])


def _meridian(shell: Shell, start: float, end: float) -> Array:
    """Radius and height (91, 2) [m] of the ``shell`` from the height ``start`` to ``end`` [m]."""
    heights = np.clip([start, end], *shell.poles)
    first, last = (shell.arc_to(float(height)) for height in heights)
    return np.stack(shell.along(np.linspace(first, last, 91)), axis=1)
