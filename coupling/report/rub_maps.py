"""Where the rubber has rubbed: the moulded hemisphere unrolled."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.tri import Triangulation

from coupling.metrics.rubs import mould_angles, rub
from coupling.ports import Array
from coupling.report.files import RunFiles
from coupling.report.page import Picture
from coupling.report.style import GREY, INK, new_figure, svg
from coupling.store.results import Results

_DPI = 200  # of the colours, which are an image; lines and letters are not
_LABELS = np.array([np.cos(np.radians(67.5)), np.sin(np.radians(67.5))])  # between two lines
_HOW = (
    "way slid from the start to the end of the run. The moulded hemisphere unrolled: its pole in "
    "the middle, its rim outside, azimuth from x to y. Ring: the largest."
)


def rub_maps(run: RunFiles) -> list[Picture]:
    """One map of the slip on the shell and one of that on the sheet itself, if there was any."""
    results = run.results
    slips = {
        f"Where it rubs on the shell: {_HOW}": results.shell_slip,
        f"Where it rubs on itself: {_HOW}": results.self_slip,
    }
    drawn = {text: _map(results, slip[-1]) for text, slip in slips.items() if len(slip)}
    return [
        Picture(source=source, caption=text, alt=text) for text, source in drawn.items() if source
    ]


def _map(results: Results, slip: Array) -> str:
    """``slip`` (n,) [m] over the mould; empty where nothing slid."""
    if rub(slip, results.reference, results.triangles) is None:
        return ""
    polar, azimuth = mould_angles(results.reference)
    x, y = np.degrees(polar) * np.cos(azimuth), np.degrees(polar) * np.sin(azimuth)
    figure = new_figure(height=3.5)
    figure.set_dpi(_DPI)
    axes = figure.subplots()
    colours = axes.tripcolor(
        Triangulation(x, y, results.triangles),
        1e3 * slip,
        shading="gouraud",
        cmap="YlOrRd",
        vmin=0.0,
        rasterized=True,
    )
    largest = int(np.argmax(slip))
    axes.plot(x[largest], y[largest], "o", markersize=9, mfc="none", mec=INK, mew=1.3)
    _graticule(axes)
    bar = figure.colorbar(colours, shrink=0.8)
    bar.outline.set_visible(False)
    bar.set_label("way slid (mm)")
    return svg(figure)


def _graticule(axes: Any) -> None:
    """Circles of polar angle and lines of azimuth, with their degrees."""
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    for circle in (30.0, 60.0, 90.0):
        axes.plot(circle * np.cos(turn), circle * np.sin(turn), color=GREY, linewidth=0.6)
    for circle in (30.0, 60.0):
        axes.text(*(circle * _LABELS), f"{circle:.0f}°", ha="center", va="bottom", fontsize=7.5)
    for degrees in range(0, 360, 45):
        out = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
        axes.plot(*np.outer(out, (30.0, 90.0)), color=GREY, linewidth=0.4)
        axes.text(*(101.0 * out), f"{degrees}°", ha="center", va="center", fontsize=7.5)
    axes.set(aspect="equal", xlim=(-112.0, 112.0), ylim=(-108.0, 108.0))
    axes.set_axis_off()
