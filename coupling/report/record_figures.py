"""Figures of runs by a record: time histories, spectra, level crossings, errors by band."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.ticker import NullLocator

from coupling.metrics.record import signals_of
from coupling.metrics.spectra import spectrum_of
from coupling.ports import Array
from coupling.report.figures import model_line
from coupling.report.files import RunFiles
from coupling.report.page import Picture
from coupling.report.style import COMPONENTS, GREY, INK, legend_above, new_figure, svg
from coupling.store.step_series import StepSeries

LABELS = {"acceleration": "tank", "cg": "CG", "force": "force", "moment": "moment"}
_DENSITY = {"acceleration": "(m/s²)²/Hz", "cg": "m²/Hz", "force": "N²/Hz"}
_SMALL = 0.01  # a component below this share of the largest one is left out
_MOST = 750  # intervals of a curve, each with its least and its largest value
_DECADES = 1e-6  # of a spectrum's largest density: what lies below is not drawn


def envelope(time: Array, values: Array, most: int = _MOST) -> tuple[Array, Array]:
    """The least and the largest value in each of ``most`` intervals, so that no peak is lost.

    ``time`` and ``values`` (S,); short curves as they are.
    """
    if len(time) <= 2 * most:
        return time, values
    parts = np.array_split(np.arange(len(time)), most)
    rows = [sorted((part[values[part].argmin()], part[values[part].argmax()])) for part in parts]
    chosen = np.concatenate(rows)
    return time[chosen], values[chosen]


def history_figure(run: RunFiles, signal: Array, label: str, caption: str) -> Picture:
    """Return a picture of the tank's acceleration, and ``signal`` (S, 3) below it, by component."""
    figure = new_figure(height=3.4)
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(1, 1.6))
    steps = run.results.steps
    _by_component(upper, steps.time, steps.tank_acceleration, width=0.7)
    _by_component(lower, steps.time, signal, width=0.9)
    upper.set_ylabel("tank (m/s²)")
    lower.set_ylabel(label)
    lower.set_xlabel("time (s)")
    legend_above(upper)
    figure.align_ylabels()
    text = f"{caption} All peaks are drawn."
    return Picture(source=svg(figure), caption=text, alt=text)


def _by_component(axes: Any, time: Array, signal: Array, width: float) -> None:
    largest = float(np.ptp(signal, axis=0).max(initial=0.0))
    for axis, (name, colour, line) in enumerate(COMPONENTS):
        if np.ptp(signal[:, axis]) >= _SMALL * largest:
            axes.plot(
                *envelope(time, signal[:, axis]), line, color=colour, label=name, linewidth=width
            )


def spectra_figure(steps: StepSeries, mark: float) -> Picture | None:
    """Return a picture of the spectra of acceleration, CG and force; None of a short run.

    ``mark``: the first slosh frequency [Hz], drawn as a line.
    """
    figure = new_figure(height=5.2)
    panels = figure.subplots(3, 1, sharex=True)
    for axes, name in zip(panels, ("acceleration", "cg", "force"), strict=True):
        found = spectrum_of(steps.time, signals_of(steps)[name])
        if found is None:
            return None
        largest = float(found.density.max(initial=0.0))
        for axis, (label, colour, line) in enumerate(COMPONENTS):
            density = found.density[1:, axis]
            if density.max(initial=0.0) > _DECADES * largest:
                axes.plot(found.frequency[1:], density, line, color=colour, label=label)
        _decades(axes, largest)
        axes.axvline(mark, color=GREY, linewidth=0.8, linestyle=":")
        axes.set_ylabel(f"{LABELS[name]} ({_DENSITY[name]})")
    legend_above(panels[0])
    panels[-1].set_xlabel("frequency (Hz)")
    figure.align_ylabels()
    text = (
        "Spectra of the tank’s acceleration, the CG and the force; dotted: the first slosh "
        "frequency. Welch’s estimate from quarters of the record, half overlapping."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _decades(axes: Any, largest: float) -> None:
    axes.set(xscale="log", yscale="log")
    if largest > 0.0:
        axes.set_ylim(_DECADES * largest, 3.0 * largest)


def crossings_figure(
    figures: Mapping[str, Mapping[str, Any]], levels: Sequence[float], signal: str, axis: int
) -> Picture:
    """Return a picture of how often ``signal`` crosses each level, one curve a run of ``figures``.

    ``axis``: which component. Dashed: Rice's counts of a Gaussian signal.
    """
    figure = new_figure(height=2.7)
    axes = figure.subplots()
    top = 1
    for model, found in figures.items():
        counts = np.array(found[signal]["crossings"][axis], dtype=float)
        top = max(top, int(counts.max(initial=0.0)))
        shown = np.where(counts > 0.0, counts, np.nan)
        look = model_line(model) if len(figures) > 1 else {"color": INK, "label": "counted"}
        axes.plot(levels, shown, marker="o", markersize=3.0, **look)
    fine = np.linspace(levels[0], levels[-1], 201)
    middle = max(found[signal]["crossings"][axis][len(levels) // 2] for found in figures.values())
    gauss = max(middle, 1) * np.exp(-0.5 * fine**2)
    axes.plot(fine, gauss, "--", color=GREY, linewidth=1.0, label="Gaussian")
    axes.set(yscale="log", xlabel="level (rms)", ylabel="crossings")
    axes.set_ylim(0.7, 2.0 * top)
    legend_above(axes, columns=3)
    text = (
        f"How often the {LABELS[signal]}’s {'xyz'[axis]} component crosses each level, away from "
        "its mean; dashed: a Gaussian signal that crosses its mean as often."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def band_errors_figure(record: Mapping[str, Any], signal: str) -> Picture:
    """Return a picture of every model's error in ``signal`` by band, and the reference's own."""
    figure = new_figure(height=2.9)
    axes = figure.subplots()
    bands = [(row["from_hz"], row["to_hz"]) for row in record["bands"]]
    names = [f"{low:g} to {high:g} Hz" for low, high in bands]
    for model, errors in record["error"].items():
        _steps_of(axes, bands, [errors[signal].get(name) for name in names], model_line(model))
    own = [(record["uncertainty"].get(signal) or {}).get(name) for name in names]
    look = {"color": GREY, "linestyle": ":", "label": "reference’s own"}
    _steps_of(axes, bands, own, look)
    axes.axhline(5.0, color=GREY, linewidth=0.7)
    axes.set(xscale="log", yscale="log", xlabel="frequency (Hz)", ylabel="error (%)")
    edges = [low for low, _ in bands[1:]]
    axes.set_xticks(edges, [f"{edge:g}" for edge in edges])
    axes.xaxis.set_minor_locator(NullLocator())
    legend_above(axes, columns=3)
    text = (
        f"Error of the {LABELS[signal]} by band: root of the spectrum of the difference over that "
        "of the reference; thin line: 5 %."
    )
    return Picture(source=svg(figure), caption=text, alt=text)


def _steps_of(
    axes: Any,
    bands: Sequence[tuple[float, float]],
    errors: Sequence[float | None],
    look: Mapping[str, Any],
) -> None:
    first = 0.5 * bands[0][1]  # the first band starts at 0, which a logarithm does not show
    edges = [first, *(high for _, high in bands)]
    values = [np.nan if value is None else 100.0 * value for value in errors]
    axes.step(edges, [values[0], *values], where="pre", **look)
