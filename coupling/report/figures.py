"""Curves over time, of one run or of several overlaid."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.lines import Line2D

from coupling.fluids.supply import volume_error
from coupling.ports import Array
from coupling.report.files import RunFiles, pressure_rms
from coupling.report.page import Picture
from coupling.report.style import (
    BLUE,
    COMPONENTS,
    GREY,
    INK,
    ORANGE,
    legend_above,
    look_of,
    new_figure,
    svg,
    thinned,
)
from coupling.store.stored_rows import blocks

_SMALL = 0.01  # a component below this share of the largest one is left out
_ABREAST = 3  # names of models in a row of a legend
_ROUNDING = 1e-9  # mm or N: what stays below it has not moved


def motion_figure(run: RunFiles, signal: Array, label: str, caption: str) -> Picture:
    """Return a picture of the tank's displacement, and ``signal`` (S, 3) below it, by component."""
    figure = new_figure(height=3.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1, 2))
    moved, time = run.results.steps.tank_displacement, run.results.steps.time
    main = int(np.argmax(np.ptp(moved, axis=0)))
    upper.plot(*thinned(time, 1e3 * moved[:, main]), color=GREY)
    upper.set_ylabel("tank (mm)")
    largest = float(np.ptp(signal, axis=0).max())
    for axis, (name, colour, line) in enumerate(COMPONENTS):
        if np.ptp(signal[:, axis]) >= _SMALL * largest:
            x, y = thinned(time, signal[:, axis])
            lower.plot(x, y, line, color=colour, label=name)
    if largest < _ROUNDING:
        lower.set_ylim(-1.0, 1.0)
    lower.set_ylabel(label)
    lower.set_xlabel("time (s)")
    legend_above(lower)
    figure.align_ylabels()
    return Picture(source=svg(figure), caption=caption, alt=caption)


def pressure_figure(run: RunFiles) -> Picture:
    """Return a picture of the rms over the diaphragm of p* and of the hydrostatic variation."""
    dynamic, hydrostatic = pressure_rms(run)
    figure = new_figure()
    axes = figure.subplots()
    time = run.results.time
    axes.plot(*thinned(time, hydrostatic / 1e3), color=ORANGE, label="hydrostatic")
    if run.has_flow:
        _plot_dynamic(axes, time, dynamic)
    _finish(axes, "rms over diaphragm (kPa)")
    text = "How strongly the hydrostatic pressure varies over the diaphragm" + (
        ", and what it omits." if run.has_flow else "; this model computes no other."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def node_pressure_figure(run: RunFiles) -> Picture:
    """Return a picture of p* and the hydrostatic pressure at the node where p* is largest."""
    results = run.results
    shown = results.dynamic_pressure if run.has_flow else results.pressure
    node = int(np.argmax(np.max([np.abs(part).max(axis=0) for (part,) in blocks(shown)], axis=0)))
    dynamic = results.dynamic_pressure[:, node]
    hydrostatic = results.pressure[:, node] - dynamic
    figure = new_figure()
    axes = figure.subplots()
    axes.plot(*thinned(results.time, hydrostatic / 1e3), color=ORANGE, label="hydrostatic")
    if run.has_flow:
        _plot_dynamic(axes, results.time, dynamic)
    _finish(axes, "pressure (kPa)")
    x, y, z = results.reference[node] * 1e3
    which = "p*" if run.has_flow else "the pressure"
    text = (
        f"At the point of the diaphragm where {which} becomes largest, moulded at "
        f"({x:.0f}, {y:.0f}, {z:.0f}) mm."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _plot_dynamic(axes: Any, time: Array, dynamic: Array) -> None:
    x, y = thinned(time, dynamic / 1e3)
    axes.plot(x, y, color=BLUE, linestyle="--", label="dynamic p*")


def coupling_figure(run: RunFiles) -> Picture:
    """Return a picture of the iterations of each step, and of the residual they left."""
    time, iteration, residual, _ = run.iterations.T
    last = np.append(time[1:] != time[:-1], True)
    earliest_after = np.append(np.minimum.accumulate(time[::-1])[::-1][1:], np.inf)
    last &= time < earliest_after  # a try that failed is followed by parts that end before it
    figure = new_figure(height=3.2)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.4))
    upper.step(*thinned(time[last], iteration[last]), where="mid", color=INK, linewidth=1.0)
    upper.set_ylabel("iterations")
    upper.set_ylim(bottom=0.0)
    x, y = thinned(time[last], np.maximum(residual[last], 1e-16))
    lower.semilogy(x, y, ".", markersize=2.5, color=BLUE, rasterized=False)
    lower.axhline(run.scene.coupling.tolerance, color=ORANGE, linewidth=1.0, linestyle="--")
    lower.set_ylabel("residual")
    lower.set_xlabel("time (s)")
    figure.align_ylabels()
    text = "Coupling iterations of every step, and the residual left; dashed: the tolerance."
    return Picture(source=svg(figure), caption=text, alt=text)


def mesh_figure(run: RunFiles) -> Picture | None:
    """Return a picture of the flow's largest non-orthogonality; None where there is no mesh."""
    steps = run.results.steps
    values = steps.metrics.get("non_orthogonality_max")
    if values is None or not np.isfinite(values).any():
        return None
    figure = new_figure()
    axes = figure.subplots()
    axes.plot(*thinned(steps.time, values), color=INK)
    axes.axhline(70.0, color=ORANGE, linewidth=1.0, linestyle="--")
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel="time (s)", ylabel="non-orthogonality (deg)")
    text = "Worst face of the flow's mesh; above 70° (dashed) the discretisation loses accuracy."
    return Picture(source=svg(figure), caption=text, alt=text)


def strain_figure(run: RunFiles) -> Picture:
    """Return a picture of the largest tensile strain over time."""
    results = run.results
    largest = np.concatenate([part.max(axis=1) for (part,) in blocks(results.strain)])
    figure = new_figure()
    axes = figure.subplots()
    axes.plot(*thinned(results.time, 100.0 * largest), color=INK)
    axes.set_ylim(bottom=0.0)
    axes.set(xlabel="time (s)", ylabel="largest tensile strain (%)")
    text = "Largest principal tensile strain of all triangles."
    return Picture(source=svg(figure), caption=text, alt=text)


def volume_figure(run: RunFiles) -> Picture:
    """Return a picture of the relative error of the liquid's volume over time."""
    figure = new_figure()
    axes = figure.subplots()
    steps = run.results.steps
    error = volume_error(run.scene, steps.time, steps.volume)
    axes.semilogy(*thinned(steps.time, np.maximum(error, 1e-17)), color=INK)
    axes.set(xlabel="time (s)", ylabel="relative volume error")
    text = "Volume under the diaphragm against the liquid's own (rounding is 1e-16)."
    return Picture(source=svg(figure), caption=text, alt=text)


def overlay(
    runs: Sequence[RunFiles], curves: Sequence[tuple[Array, Array]], label: str, caption: str
) -> Picture:
    """Return a picture with one curve of each run, times and values (T,), in its model's colour."""
    figure = new_figure(height=2.7)
    axes = figure.subplots()
    for run, curve in zip(runs, curves, strict=True):
        axes.plot(*thinned(*curve), **model_line(run.label))
    axes.set(xlabel="time (s)", ylabel=label)
    legend_above(axes, columns=_ABREAST)
    return Picture(source=svg(figure), caption=caption, alt=caption)


def model_line(model: str) -> dict[str, Any]:
    """Return colour, dashes and label of a model's curve, the same in all figures."""
    colour, dashes = look_of(model)
    return {"color": colour, "linestyle": dashes, "label": model}


def model_legend(models: Sequence[str]) -> Picture:
    """Return a picture of the models' lines by name."""
    rows = -(-len(models) // _ABREAST)
    figure = new_figure(height=0.15 + 0.2 * rows)
    lines = [Line2D([], [], **model_line(model)) for model in models]
    figure.legend(handles=lines, loc="center", ncols=_ABREAST)
    return Picture(source=svg(figure), caption="", alt="Models: " + ", ".join(models))


def _finish(axes: Any, label: str) -> None:
    axes.set(xlabel="time (s)", ylabel=label)
    legend_above(axes)
