"""Maps and curves of a sweep's errors."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import BoundaryNorm
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from coupling.metrics.advice import LEVELS
from coupling.ports import Array
from coupling.report.page import Picture
from coupling.report.style import GREY, INK, LIGHT, ORANGE, legend_above, new_figure, svg
from coupling.report.sweep_grid import FREQUENCY, Grid, label

_BANDS = [0.5, 1, 2, 5, 10, 20, 50, 100]  # percent
_MOST_CURVES = 8


def error_map(grid: Grid, model: str, name: str, word: str, *, ratio: bool) -> Picture | None:
    """``model``'s error in colours over the two axes; over f/f1 instead of Hz with ``ratio``.

    None where ``ratio`` is asked for and not known at every point.
    """
    across = grid.keys.index(FREQUENCY) if FREQUENCY in grid.keys else 0
    up = 1 - across
    x, y = grid.coordinates(across), grid.coordinates(up)
    error = 100.0 * grid.error(model, name)
    if ratio:
        x = grid.number("frequency_ratio")
        if FREQUENCY not in grid.keys or not np.isfinite(x).all():
            return None
    figure = new_figure(height=3.2)
    axes = figure.subplots()
    norm = BoundaryNorm(_BANDS, 256, extend="both")
    scales = grid.logarithmic(across), grid.logarithmic(up)
    mesh = axes.pcolormesh(
        _corners(x, logarithmic=scales[0]),
        _corners(y, logarithmic=scales[1]),
        np.ma.masked_invalid(error),
        cmap=colormaps["YlGnBu"],
        norm=norm,
    )
    bar = figure.colorbar(mesh, ax=axes, ticks=_BANDS, extend="both")
    bar.set_label(f"error in {word} (%)")
    bar.ax.yaxis.set_major_formatter(FuncFormatter(_plain))
    _contours(axes, x, y, error)
    axes.plot(x, y, ".", color=GREY, markersize=1.5)
    failed = grid.failed()
    axes.plot(x[failed], y[failed], "x", color=ORANGE, markersize=5, markeredgewidth=1.4)
    axes.grid(False)
    _scale(axes, "x", scales[0])
    _scale(axes, "y", scales[1])
    axes.set(xlabel="f/f₁" if ratio else label(grid.keys[across]), ylabel=label(grid.keys[up]))
    text = f"Error of {model} in {word}; lines at 1, 5 and 20\u202f%."
    return Picture(source=svg(figure), caption=text + _crosses(grid), alt=text)


def _corners(values: Array, *, logarithmic: bool) -> Array:
    """Corners (m + 1, n + 1) of the cells round ``values`` (m, n), half way to the next."""
    corners = np.log(values) if logarithmic else values
    for axis in (0, 1):
        if corners.shape[axis] == 1:  # no neighbour: a width of its own
            wide = 0.05 * np.maximum(np.abs(corners), 1.0)
            corners = np.concatenate([corners - wide, corners + wide], axis=axis)
            continue
        half = np.diff(corners, axis=axis) / 2.0
        ends = [0], [-1]
        first = corners.take(ends[0], axis) - half.take(ends[0], axis)
        last = corners.take(ends[1], axis) + half.take(ends[1], axis)
        middle = corners.take(range(corners.shape[axis] - 1), axis) + half
        corners = np.concatenate([first, middle, last], axis=axis)
    return np.exp(corners) if logarithmic else corners


def _contours(axes: Any, x: Array, y: Array, error: Array) -> None:
    known = error[np.isfinite(error)]
    levels = [100.0 * level for level in LEVELS]
    inside = [level for level in levels if known.size and known.min() < level < known.max()]
    if min(error.shape) < 2 or not inside:
        return
    lines = axes.contour(x, y, np.ma.masked_invalid(error), inside, colors=INK, linewidths=0.9)
    axes.clabel(lines, fmt=lambda value: f"{value:g} %", fontsize=7.5)


def error_curves(grid: Grid, name: str, word: str, *, ratio: bool) -> Picture:
    """Errors against the first axis, or f/f1: a curve a model, or a value of the second axis."""
    figure = new_figure(height=2.9)
    axes = figure.subplots()
    for level in LEVELS:
        axes.axhline(100.0 * level, color=LIGHT, linewidth=1.0)
    along = grid.keys.index(FREQUENCY) if FREQUENCY in grid.keys else 0
    x = grid.number("frequency_ratio") if ratio else grid.coordinates(along)
    if len(grid.keys) == 1:
        for model in grid.lesser:
            _curve(axes, x, grid.error(model, name), label=model)
    else:
        _family(axes, grid, along, x, grid.error(grid.lesser[0], name))
    if ratio and name == "cg_amplitude" and np.isfinite(x).any():
        ends = np.array([np.nanmin(x), np.nanmax(x)])
        axes.plot(ends, 100.0 * ends**2, ":", color=GREY, label="(f/f₁)²")
    failed = grid.failed() & np.isfinite(x)
    at_the_foot: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "clip_on": False}
    foot = np.zeros(int(failed.sum()))
    axes.plot(x[failed], foot, "x", color=ORANGE, markeredgewidth=1.4, **at_the_foot)
    _scale(axes, "x", True)
    _scale(axes, "y", True)
    axes.set(xlabel="f/f₁" if ratio else label(grid.keys[along]), ylabel=f"{word} (%)")
    legend_above(axes, columns=3)
    whose = ", ".join(grid.lesser if len(grid.keys) == 1 else grid.lesser[:1])
    text = f"Error in {word} of {whose}; grey lines at 1, 5 and 20\u202f%."
    return Picture(source=svg(figure), caption=text + _crosses(grid), alt=text)


def figure_curves(grid: Grid, name: str) -> Picture:
    """A figure that was wanted against the only axis: a curve a model."""
    figure = new_figure(height=2.6)
    axes = figure.subplots()
    x = grid.coordinates(0)
    for model in grid.content["models"]:
        axes.plot(x, grid.wanted(model, name), ".-", markersize=4, label=model)
    _scale(axes, "x", grid.logarithmic(0))
    axes.set(xlabel=label(grid.keys[0]), ylabel=name)
    legend_above(axes, columns=3)
    text = f"{name} over {grid.keys[0]}."
    return Picture(source=svg(figure), caption=text, alt=text)


def _family(axes: Any, grid: Grid, along: int, x: Array, error: Array) -> None:
    """A curve for each value of the other axis; with more axes, points alone."""
    if len(grid.keys) > 2:
        axes.plot(x.ravel(), 100.0 * error.ravel(), ".", color=INK, label=grid.lesser[0])
        return
    other = 1 - along
    values = grid.axis(other)
    shown = np.unique(np.linspace(0, len(values) - 1, _MOST_CURVES).round().astype(int))
    for place, index in enumerate(shown):
        colour = colormaps["viridis"](0.9 * place / max(len(shown) - 1, 1))
        text = f"{label(grid.keys[other])} {values[index]:.3g}"
        _curve(axes, x.take(index, other), error.take(index, other), label=text, color=colour)


def _curve(axes: Any, x: Array, error: Array, **drawn: Any) -> None:
    axes.plot(x, 100.0 * error, ".-", markersize=4, **drawn)


def _scale(axes: Any, direction: str, logarithmic: bool) -> None:
    """Logarithmic where asked, and where there is anything positive to show."""
    low, high = getattr(axes, f"get_{direction}lim")()
    if not logarithmic or not high > 0.0:
        return
    getattr(axes, f"set_{direction}scale")("log", nonpositive="mask")
    axis = getattr(axes, f"{direction}axis")
    axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0) if high < 3e3 * low else (1.0,)))
    axis.set_major_formatter(FuncFormatter(_plain))
    axis.set_minor_formatter(NullFormatter())


def _plain(value: float, _: int) -> str:
    return f"{value:g}"


def _crosses(grid: Grid) -> str:
    return " Crosses: a model failed." if grid.failed().any() else ""
