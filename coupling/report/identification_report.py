"""The report of an identification: pendulums, what they rest on, and what they follow."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from coupling.report.page import Page, Picture, Section, Table, number, percent
from coupling.report.style import BLUE, GREY, INK, ORANGE, legend_above, new_figure, svg

_WAVE = {"mass_kg": "m [kg]", "frequency_hz": "f [Hz]", "damping_ratio": "damping ratio"}
_PENDULUM = {
    "pendulum_length_m": "length [m]",
    "hinge_height_m": "hinge height [m]",
    "spring_rate_n_m": "spring rate [N/m]",
}
_FINE = 400  # frequencies at which a model's curve is drawn


def identification_page(folder: Path, content: Mapping[str, Any]) -> Page:
    """Page of an identification from what its ``mechanical_model.json`` holds."""
    rows = content["rows"]
    known = [row for row in rows if row["failure"] is None]
    failed = [row for row in rows if row["failure"] is not None]
    verdict, explanation = _verdict(content, known)
    sections = [*_models(known), _checks(content, known), *map(_apparent_mass, known)]
    if failed:
        sections.insert(0, _failures(failed))
    return Page(
        title=content["title"] or f"{folder.resolve().name}: mechanical model",
        subtitle=f"conditions (fill and amplitude): {len(rows)} · liquid: {content['model']}",
        verdict=verdict,
        explanation=explanation,
        alarm=_alarm(content, known, failed),
        sections=sections,
        footer="Figures: mechanical_model.csv and mechanical_model.json; runs: "
        "points/<condition>/<run>; for NASTRAN, FMI and Basilisk: exports/<condition>.",
    )


def _verdict(content: Mapping[str, Any], known: list[Mapping[str, Any]]) -> tuple[str, str]:
    checks = [check for row in known for check in row["validation"] if check["failure"] is None]
    if not checks:
        return "Nothing was held against a model.", "It takes runs that complete."
    good = sum(bool(check["followed"]) for check in checks)
    limit = percent(content["followed_within"])
    worst = max(check["force_error"] or 0.0 for check in checks)
    return (
        f"The models follow {good} of {len(checks)} scenes that they were not fitted to within "
        f"{limit} of the force.",
        f"Error is the rms over time of the force that is missed over that of the force; at worst "
        f"it is {percent(worst)}. A model holds for its own fill and amplitude.",
    )


def _alarm(
    content: Mapping[str, Any],
    known: list[Mapping[str, Any]],
    failed: list[Mapping[str, Any]],
) -> str:
    said = []
    if failed:
        rows = len(content["rows"])
        said.append(f"{len(failed)} of {rows} conditions have no model.")
    missed = {_condition(row): row["left_out_error"][str(len(row["modes"]))] for row in known}
    apart = [
        f"{condition} ({percent(error)})"
        for condition, error in missed.items()
        if error > content["linear_within"]
    ]
    if apart:
        said.append(
            f"The model of one sweep misses the other at {'; '.join(apart)}: the motion is not "
            "linear there, and a model means little. Sway less, or calm the diaphragm’s short "
            "waves (cloth.fold_damping)."
        )
    return " ".join(said)


def _models(known: list[Mapping[str, Any]]) -> list[Section]:
    waves, pendulums = [], []
    for row in known:
        fixed = [_told(row, "fixed_mass_kg"), "", "", _told(row, "fixed_height_m")]
        waves.append([f"{_condition(row)}, fixed", *fixed[:3]])
        pendulums.append([f"{_condition(row)}, fixed", "", fixed[3], ""])
        for place, mode in enumerate(row["modes"], start=1):
            name = f"{_condition(row)}, mode {place}"
            waves.append([name, *(_told(mode, figure) for figure in _WAVE)])
            pendulums.append([name, *(_told(mode, figure) for figure in _PENDULUM)])
    note = (
        "± two standard errors: the larger of what the residual allows and what fits of either "
        "sweep alone differ by. They hold neither the error of the grids nor that of the step. "
        "Heights are above the tank’s centre, against gravity."
    )
    first = "Fill, amplitude"
    return [
        Section(
            title="The modes",
            tables=[Table(head=[first, *_WAVE.values()], rows=waves, note=note)],
        ),
        Section(
            title="As pendulums and as springs",
            tables=[Table(head=[first, *_PENDULUM.values()], rows=pendulums)],
        ),
    ]


def _told(item: Mapping[str, Any], name: str) -> str:
    """A figure and its error, to the error's second digit."""
    value, error = item[name], item[f"{name}_error"]
    if not 0.0 < error < 1e-2 * abs(value):
        return f"{number(value)} ± {number(error, digits=2)}"
    digits = int(np.floor(np.log10(abs(value))) - np.floor(np.log10(error))) + 2
    return f"{number(value, digits=digits)} ± {number(error, digits=2)}"


def _condition(row: Mapping[str, Any]) -> str:
    return f"{row['fill_fraction']:g}, {1e3 * row['amplitude_m']:g}\u202fmm"


def _checks(content: Mapping[str, Any], known: list[Mapping[str, Any]]) -> Section:
    rows = [
        [
            _condition(row),
            f"{check['says']}, {1e3 * check.get('amplitude_m', row['amplitude_m']):g}\u202fmm",
            check["failure"] or percent(check["force_error"]),
            "" if check["followed"] is None else "yes" if check["followed"] else "no",
        ]
        for row in known
        for check in (*row["validation"], *row["other_amplitudes"])
    ]
    limit = percent(content["followed_within"])
    head = ["Model of", "Scene that it was not fitted to", "rms error of the force", f"≤ {limit}"]
    orders = [
        [
            _condition(row),
            *(percent(row["left_out_error"].get(str(count))) for count in (1, 2, 3)),
            str(len(row["modes"])),
            percent(row["coherence_least"]),
        ]
        for row in known
    ]
    heads = ["Fill, amplitude", "1 mode", "2 modes", "3 modes", "taken", "least coherence"]
    note = (
        "Error of the force of a sweep that was left out of the fit, by number of modes. Coherence "
        "is 1 where both sweeps show the same apparent mass, less where the motion is not linear."
    )
    return Section(
        title="How well they are followed",
        tables=[Table(head=head, rows=rows), Table(head=heads, rows=orders, note=note)],
    )


def _apparent_mass(row: Mapping[str, Any]) -> Section:
    return Section(
        title=f"Apparent mass: {_condition(row)}",
        pictures=[_picture(row, np.abs, "size"), _picture(row, np.angle, "phase")],
    )


def _picture(row: Mapping[str, Any], of: Any, what: str) -> Picture:
    curve = {name: np.array(values) for name, values in row["apparent_mass"].items()}
    found = curve["real_kg"] + 1j * curve["imag_kg"]
    even = np.linspace(curve["frequency_hz"][0], curve["frequency_hz"][-1], _FINE)
    model = _model(row, even)
    figure = new_figure(height=2.7)
    axes = figure.subplots()
    frequency, error = curve["frequency_hz"], curve["error_kg"]
    if what == "phase":
        scale, label = 180.0 / np.pi, "phase of −F/a (degrees)"
        error = error / np.maximum(np.abs(found), 1e-300)
    else:
        scale, label = 1.0 / row["liquid_mass_kg"], "|F/a| over the liquid’s mass"
    axes.errorbar(
        frequency, scale * of(found), scale * error, fmt=".", color=INK, markersize=3.5,
        elinewidth=0.8, label="runs",
    )  # fmt: skip
    axes.plot(even, scale * of(model), color=BLUE, label="model")
    axes.axvline(row["modes"][0]["frequency_hz"], color=ORANGE, linewidth=0.9, label="first mode")
    axes.set(xlabel="frequency (Hz)", ylabel=label)
    if what == "size":
        axes.set_yscale("log")
    else:
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        axes.set_ylim(-190.0, 190.0)
    legend_above(axes, columns=3)
    text = f"Apparent mass, its {what}: both sweeps ± two standard errors, and the model."
    return Picture(source=svg(figure), caption=text, alt=text)


def _model(row: Mapping[str, Any], frequency: Any) -> Any:
    """Apparent mass [kg], complex, of a row's fixed mass and modes at ``frequency`` [Hz]."""
    mass = np.full(len(frequency), row["fixed_mass_kg"], dtype=complex)
    for mode in row["modes"]:
        ratio = frequency / mode["frequency_hz"]
        damped = 1.0 + 2j * mode["damping_ratio"] * ratio
        mass += mode["mass_kg"] * damped / (damped - ratio**2)
    return mass


def _failures(failed: list[Mapping[str, Any]]) -> Section:
    rows = [[_condition(row), str(row["failure"])] for row in failed]
    return Section(
        title="Failures",
        tables=[Table(head=["Fill, amplitude", "Reason"], rows=rows, numbers=False)],
    )
