"""Where the rubber has rubbed: the moulded shape unrolled, and the shell."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.tri import Triangulation

from coupling.metrics.places import mould_angles, shell_angles
from coupling.metrics.rubs import LEAST, rub
from coupling.ports import Array
from coupling.report.files import RunFiles
from coupling.report.page import Picture
from coupling.report.style import GREY, INK, new_figure, svg
from coupling.store.results import Results

_DPI = 200  # of the colours, which are an image; lines and letters are not
_LABELS = np.array([np.cos(np.radians(67.5)), np.sin(np.radians(67.5))])  # between two lines
_UNROLLED = (
    "from the start to the end of the run. The moulded shape unrolled: its pole in "
    "the middle, its rim outside, azimuth from x to y. Ring: the largest."
)
_WAY = (1e3, "way slid (mm)", f"way slid {_UNROLLED}")
_WORK = (1.0, "slip work (J/m²)", f"pressure times way slid {_UNROLLED}")


def rub_maps(run: RunFiles) -> list[Picture]:
    """Maps of the slip on the shell, and of that on the sheet itself, and of their works.

    Those of which there was none are left out.
    """
    results, pictures = run.results, []
    if not len(results.time):
        return []
    for kind, name in (("shell", "the shell"), ("self", "itself")):
        slip, work = (getattr(results, f"{kind}_{what}")[-1] for what in ("slip", "work"))
        for values, (scale, label, how) in ((slip, _WAY), (work, _WORK)):
            if not (np.nanmax(slip, initial=0.0) > LEAST and np.nanmax(values, initial=0.0) > 0.0):
                continue
            text = f"Where it rubs on {name}: {how}"
            source = mould_map(results, scale * values, label)
            pictures.append(Picture(source=source, caption=text, alt=text))
    return pictures


def shell_map(run: RunFiles) -> list[Picture]:
    """A map of the shell with the sheet's nodes where they rubbed; empty where none did."""
    results = run.results
    if not len(results.time):
        return []
    slip, work = results.shell_slip[-1], results.shell_work[-1]
    done = rub(np.where(slip > LEAST, work, 0.0), results.reference, results.triangles, least=0.0)
    if done is None:
        return []
    polar, azimuth = shell_angles(results.rub_place[-1])
    order = np.argsort(work)  # the largest on top
    order = order[work[order] > 0.01 * done.largest]
    x, y = np.degrees(azimuth[order]) % 360.0, np.degrees(polar[order]) - 90.0
    figure = new_figure()
    axes = figure.subplots()
    dots = axes.scatter(x, y, s=9.0, c=work[order], cmap="YlOrRd", vmin=0.0, linewidths=0.0)
    axes.axhline(0.0, color=GREY, linewidth=0.7)
    axes.plot(x[-1], y[-1], "o", markersize=9, mfc="none", mec=INK, mew=1.3)
    axes.set(
        xlim=(0.0, 360.0), xticks=range(0, 361, 90), xlabel="azimuth from x to y (°)",
        ylabel="above the rim (°)",
    )  # fmt: skip
    bar = figure.colorbar(dots)
    bar.outline.set_visible(False)
    bar.set_label("slip work (J/m²)")
    text = (
        "Which part of the shell it rubs on: every point of the rubber at the mean place of its "
        "slip work, seen from the middle of the rim. Points below a hundredth of the largest, "
        "which has a ring, are left out."
    )
    return [Picture(source=svg(figure), caption=text, alt=text)]


def mould_map(results: Results, values: Array, label: str) -> str:
    """``values`` (n,), in the unit that the ``label`` of their scale has, over the mould."""
    polar, azimuth = mould_angles(results.reference)
    x, y = np.degrees(polar) * np.cos(azimuth), np.degrees(polar) * np.sin(azimuth)
    figure = new_figure(height=3.5)
    figure.set_dpi(_DPI)
    axes = figure.subplots()
    colours = axes.tripcolor(
        Triangulation(x, y, results.triangles),
        values,
        shading="gouraud",
        cmap="YlOrRd",
        vmin=0.0,
        rasterized=True,
    )
    largest = int(np.argmax(values))
    axes.plot(x[largest], y[largest], "o", markersize=9, mfc="none", mec=INK, mew=1.3)
    graticule(axes)
    bar = figure.colorbar(colours, shrink=0.8)
    bar.outline.set_visible(False)
    bar.set_label(label)
    return svg(figure)


def graticule(axes: Any) -> None:
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
