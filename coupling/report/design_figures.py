"""Curves of a design: the least thickness over the radius, and what it was found from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from coupling.metrics.criteria import CRITERIA
from coupling.report.page import Picture, number
from coupling.report.picture import draw_tank, pressure_colours
from coupling.report.style import BLUE, GREY, INK, LIGHT, ORANGE, legend_above, new_figure, png, svg
from coupling.scene.scene import load_scene
from coupling.store.results import open_results

Row = Mapping[str, Any]


def thickness_figure(rows: Sequence[Row]) -> Picture:
    """Every run over radius and thickness, with the brackets between which the limit is met."""
    figure = new_figure(height=3.4)
    axes = figure.subplots()
    looks: dict[bool | None, dict[str, Any]] = {
        True: {"marker": "o", "color": BLUE, "label": "keeps the limit"},
        False: {"marker": "o", "color": ORANGE, "mfc": "none", "label": "misses it"},
        None: {"marker": "x", "color": GREY, "label": "failed"},
    }
    for kept, look in looks.items():
        runs = [run for row in rows for run in row["runs"] if run["kept"] is kept]
        if runs:
            places = np.array([(run["radius_m"], 1e3 * run["thickness_m"]) for run in runs])
            axes.plot(*places.T, linestyle="none", markersize=4, **look)
    bracketed = [row for row in rows if None not in (row["too_thin_m"], row["enough_m"])]
    for row in bracketed:
        ends = 1e3 * np.array([row["too_thin_m"], row["enough_m"]])
        axes.plot([row["radius_m"]] * 2, ends, color=INK, linewidth=4, alpha=0.5)
    if bracketed:
        x = [row["radius_m"] for row in bracketed]
        axes.plot(x, [1e3 * row["enough_m"] for row in bracketed], "-", color=INK, label="enough")
    _logarithmic(axes, "y")
    axes.set(xlabel="radius (m)", ylabel="thickness (mm)")
    legend_above(axes)
    text = "Least thickness that keeps the limit, over the radius; the bracket of each in grey."
    return Picture(source=svg(figure), caption=text, alt=text)


def value_figure(rows: Sequence[Row], limit: float, criterion: str) -> Picture:
    """The criterion's value over the thickness, a curve a radius, with the limit."""
    figure = new_figure(height=3.4)
    axes = figure.subplots()
    axes.axhline(limit, color=LIGHT, linewidth=2.0)
    for place, row in enumerate(rows):
        runs = [run for run in row["runs"] if run["value"] is not None]
        x, y = [1e3 * run["thickness_m"] for run in runs], [run["value"] for run in runs]
        colour = colormaps["viridis"](0.9 * place / max(len(rows) - 1, 1))
        axes.plot(x, y, ".-", markersize=4, color=colour, label=f"R = {row['radius_m']:.3g} m")
    _logarithmic(axes, "x")
    axes.set(xlabel="thickness (mm)", ylabel=criterion)
    legend_above(axes, columns=3)
    text = f"The criterion over the thickness; grey: its limit, {limit:g}."
    return Picture(source=svg(figure), caption=text, alt=text)


def worst_instants(folder: Path, row: Row, criterion: str, model: str) -> list[Picture]:
    """The diaphragm of a radius at its worst instant, at both ends of its bracket."""
    pictures = []
    for name, word in (("too_thin_m", "too thin"), ("enough_m", "enough")):
        run = next((one for one in row["runs"] if one["thickness_m"] == row[name]), None)
        if run is None:
            continue
        place = folder / "points" / run["point"] / model
        results, scene = open_results(place), load_scene(place)
        worst = int(np.argmax(CRITERIA[criterion].badness(results, scene)))
        figure = Figure(figsize=(2.4, 2.4))
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d")
        draw_tank(axes, results, worst, pressure_colours(results, [worst]), scene.tank.shell)
        thickness = number(1e3 * run["thickness_m"], "mm")
        text = (
            f"R = {number(row['radius_m'], 'm')}, {thickness}, {word}: "
            f"{number(run['value'])}, at t = {results.time[worst]:.3f} s"
        )
        pictures.append(Picture(source=png(figure), caption=text, alt=f"Diaphragm in it. {text}"))
    return pictures


def _logarithmic(axes: Any, direction: str) -> None:
    getattr(axes, f"set_{direction}scale")("log")
    axis = getattr(axes, f"{direction}axis")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.set_minor_formatter(NullFormatter())
