"""The sections of a report on a motion that follows a record: no period, no amplitude."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from coupling.estimate.numbers import numbers_of
from coupling.metrics.record import LEVELS, signals_of
from coupling.metrics.record_errors import band_name
from coupling.metrics.record_verdict import enough
from coupling.report.files import RunFiles
from coupling.report.page import Section, Table, number, percent
from coupling.report.record_figures import (
    band_errors_figure,
    crossings_figure,
    history_figure,
    spectra_figure,
)

_SHOWN = {"acceleration": 1.0, "cg": 1e3, "force": 1.0, "moment": 1.0}
_HEADS = {
    "acceleration": "tank (m/s²)",
    "cg": "CG (mm)",
    "force": "force (N)",
    "moment": "moment (N m)",
}
_LEAST = 1e-5  # of the largest component: what lies below is the solver's noise


def record_sections(run: RunFiles) -> list[Section]:
    """How CG, force and moment answer to the record, over time, by level and by band."""
    record, steps = run.summary["record"], run.results.steps
    about = {name: one - one.mean(axis=0) for name, one in signals_of(steps).items()}
    figures = {run.model: record["signals"]}
    spectra = spectra_figure(steps, numbers_of(run.scene).slosh_frequency)
    bands = band_table(record)
    return [
        Section(
            title="Answer to the record",
            tables=[statistics_table(record)],
            pictures=[
                history_figure(run, 1e3 * about["cg"], "CG (mm)", "Tank, and the liquid’s CG."),
                history_figure(run, about["force"], "force (N)", "Tank, and the liquid’s force."),
                *(
                    crossings_figure(figures, LEVELS, name, _main(record["signals"][name]))
                    for name in ("cg", "force")
                ),
            ],
        ),
        Section(
            title="By band of frequency",
            tables=[bands] if bands else [],
            text="" if bands else "The run is too short for a spectrum.",
            pictures=[spectra] if spectra else [],
            columns=1,
        ),
    ]


def _main(figures: Mapping[str, Any]) -> int:
    """The component that moves most."""
    return int(np.argmax(figures["rms"]))


def statistics_table(record: Mapping[str, Any]) -> Table:
    """Rms and peak of every signal's components, and the peak over the rms."""
    rows = []
    for name, scale in _SHOWN.items():
        found = record["signals"][name]
        largest = max(found["rms"])
        for axis, letter in enumerate("xyz"):
            rms, peak = found["rms"][axis], found["peak"][axis]
            moved = rms > _LEAST * largest
            rows.append([
                f"{_HEADS[name]}, {letter}",
                number(scale * rms) if moved else "0",
                number(scale * peak) if moved else "0",
                number(peak / rms) if moved else "–",
                *_counts(found["crossings"][axis]),
            ])  # fmt: skip
    return Table(
        head=["", "rms", "peak", "peak/rms", "over 0", "1", "2", "3 rms"],
        rows=rows,
        note="Rms and peak, the largest size, about the mean of the run, of every step; CG in the "
        "tank’s frame, force and moment on tank and diaphragm, the moment about the tank’s centre. "
        "Last: how often the level of 0, 1, 2, 3 rms is crossed away from the mean, to either "
        "side. The run starts from rest: the first slosh periods hold a transient of that. A peak "
        "is that of this record; another one of the same spectrum has another.",
    )


def _counts(crossed: Sequence[int]) -> list[str]:
    """Crossings of 0, and of 1, 2, 3 rms to either side."""
    middle = LEVELS.index(0.0)
    sides = [LEVELS.index(level) - middle for level in (1.0, 2.0, 3.0)]
    both = [crossed[middle - side] + crossed[middle + side] for side in sides]
    return [str(count) for count in (crossed[middle], *both)]


def band_table(record: Mapping[str, Any]) -> Table | None:
    """Rms of every signal in each octave; None of a run too short for a spectrum."""
    if not record["bands"]:
        return None
    rows = []
    for row in record["bands"]:
        sizes = {name: float(np.linalg.norm(row["rms"][name])) for name in _SHOWN}
        rows.append([
            _band(row),
            *(number(scale * sizes[name]) for name, scale in _SHOWN.items()),
            percent(row["random_error"]),
        ])  # fmt: skip
    return Table(
        head=["Hz", *_HEADS.values(), "scatter"],
        rows=rows,
        note="Rms within each octave, over all three axes. Scatter: by how much the rms of another "
        "record of the same spectrum would differ, 1/(2√(BT)) of a band B and a record T.",
    )


def _band(row: Mapping[str, float]) -> str:
    return f"{row['from_hz']:g} to {row['to_hz']:.4g}"


def study_sections(record: Mapping[str, Any], reference: str) -> list[Section]:
    """Errors of the models by band, and rms, peaks and crossings of each."""
    models = record["models"]
    crossed = [
        crossings_figure(models, models[reference]["levels_rms"], name, _main(best))
        for name in ("cg", "force")
        for best in (models[reference][name],)
    ]
    by_model = Section(
        title="Rms, peaks and level crossings", tables=[models_table(models)], pictures=crossed
    )
    if not record["bands"]:
        return [by_model]
    pictures = [band_errors_figure(record, name) for name in ("cg", "force")]
    return [
        Section(
            title="By band of frequency",
            text=f"Which part of the spectrum the tank answers to, by {reference}, and how far "
            "each model is off there.",
            tables=[band_errors_table(record, reference)],
            pictures=pictures,
        ),
        by_model,
    ]


def models_table(models: Mapping[str, Mapping[str, Any]]) -> Table:
    """One row a model: rms and peak of CG and force over all axes, and slip."""
    rows = []
    for name, found in models.items():
        cells = []
        for signal in ("cg", "force", "moment"):
            axis, scale = _main(found[signal]), _SHOWN[signal]
            cells += [
                number(scale * float(np.linalg.norm(found[signal]["rms"]))),
                number(scale * found[signal]["peak"][axis]),
            ]
        slip = found["shell_slip_max_m"]
        rows.append([name, *cells, number(None if slip is None else 1e3 * slip)])
    heads = [f"{_HEADS[name]}, {what}" for name in ("cg", "force", "moment") for what in _WHAT]
    return Table(
        head=["Model", *heads, "slip on the shell (mm)"],
        rows=rows,
        note="Rms over all axes, peak of the component that moves most, both about the mean; the "
        "slip is the largest, gathered over the run.",
    )


_WHAT = ("rms", "peak")


def band_errors_table(record: Mapping[str, Any], reference: str) -> Table:
    """One row a band: what the reference answers, and every model's error in CG and force."""
    bars = record["uncertainty"]
    heads = [f"{model}: {signal}" for model in record["error"] for signal in ("CG", "force")]
    rows = []
    for row in record["bands"]:
        name = band_name((row["from_hz"], row["to_hz"]))
        cells = [
            _error(errors[signal].get(name), bars[signal].get(name))
            for errors in record["error"].values()
            for signal in ("cg", "force")
        ]
        rows.append([
            _band(row), number(row["acceleration_rms"]), number(1e3 * row["cg_rms_m"]),
            percent(row["cg_share"]), number(row["force_over_ma"]), *cells,
        ])  # fmt: skip
    whole = [
        _error(errors[signal].get("all"), bars[signal].get("all"))
        for errors in record["error"].values()
        for signal in ("cg", "force")
    ]
    rows.append(["all", "", "", "", "", *whole])
    return Table(
        head=["Hz", "tank (m/s²)", "CG (mm)", "of its power", "force/(m a)", *heads],
        rows=rows,
        note=f"The first columns are rms of {reference} in each octave, over all axes; force/(m a) "
        "would be 1 for a liquid that moves as one body with the tank. Errors: root of the "
        "spectrum of the difference over that of the reference, amplitude and phase in one; ± is "
        "the reference’s own, as its other runs let it be estimated. ✓: both together below 5 %, "
        "the model was enough there.",
    )


def _error(value: float | None, bar: float | None) -> str:
    if value is None:
        return "–"
    text = percent(value) + ("" if bar is None else f" ± {percent(bar)}")
    return f"{text} ✓" if enough(value, bar) else text
