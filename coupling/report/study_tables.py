"""Tables of a study: errors with their bars, and speed against error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coupling.fluids import FLUIDS
from coupling.metrics.comparison import Errors
from coupling.report.page import Table, number, percent
from coupling.report.study_figures import COLUMNS, RESOLUTIONS, SOURCES

_TIMES = (
    "Wall times are of one run each, settling included; all kernels were compiled before the first."
)


def errors_table(study: Mapping[str, Any]) -> Table:
    """One row a model: wall time and every error with its bar; then the reference's own."""
    reference, rows = study["reference"], []
    bars: Errors = study.get("uncertainty") or {}
    for name, row in study["models"].items():
        errors, below = row.get("error") or {}, row.get("below_reference_error") or []
        cells = [_cell(key, errors.get(key), bars.get(key), key in below) for key in COLUMNS]
        if name == reference:
            cells = ["reference"] + [""] * (len(COLUMNS) - 1)
        elif row.get("failure"):
            cells = ["failed"] + [""] * (len(COLUMNS) - 1)
        rows.append([name, number(row.get("wall_s"), "s"), times(row.get("speedup")), *cells])
        same = row.get("against_same_model")
        if same:
            cells = [_cell(key, same.get(key), None, False) for key in COLUMNS]
            rows.append([f"… against {row['model']}", "", "", *cells])
    for key, errors in study["discretisation"].items():
        if key in SOURCES:  # in the table of sources
            continue
        cells = [_cell(name, errors.get(name), None, False) for name in COLUMNS]
        rows.append([f"{reference}, {_own(key, reference)}", "", "", *cells])
    return Table(
        head=["Model", "wall time", "speed-up", *COLUMNS.values()],
        rows=rows,
        note=_note(study),
    )


def _note(study: Mapping[str, Any]) -> str:
    note = (
        f"Errors are relative to the reference’s own figure, but for the phase. {_TIMES} "
        "The last rows are the reference itself, less resolved, or stiffer. "
    )
    if study.get("uncertainty"):
        note += (
            "± is the reference’s own error as these rows let it be estimated (Richardson: the "
            "step’s error taken as of second order, the flow mesh’s of order 1.5, the diaphragm’s "
            "of second; what an inextensible sheet still stretches as its compliance)"
        )
        if "coarser_diaphragm" not in study["discretisation"]:
            note += (
                "; where openfoam is the reference, the rows have the same diaphragm, and ± knows "
                "nothing of its mesh"
            )
        note += ". "
    note += "≈ marks an error below that, where no difference between the models is resolved."
    if any(row.get("against_same_model") for row in study["models"].values()):
        note += (
            " The diaphragm that stretches by its own compliance, or does not, is held against "
            "the same fluid model too: that difference is the stretching alone."
        )
    return note


def sources_table(study: Mapping[str, Any]) -> Table | None:
    """What each source of error is worth in every figure; None for a study that has none."""
    sources, reference = study.get("sources") or [], study["reference"]
    if not sources:
        return None
    rows = []
    for one in sources:
        name = one["source"]
        text = SOURCES.get(name) or _own(name, reference)
        if one["kind"] == "unknown":
            text += f" ({one['row']})"
        share = one["share"]
        rows.append([
            text, "error" if one["kind"] == "numerical" else "change",
            *(_cell(key, share.get(key), None, False) for key in COLUMNS),
        ])  # fmt: skip
    orders = (study.get("observed_order") or {}).get("coarser_grid") or {}
    seen = ", ".join(
        f"{COLUMNS[key]} {value:.1f}" for key, value in orders.items() if value is not None
    )
    note = (
        "“Error”: the reference’s own, estimated from one run with that source alone enlarged; "
        "the bars ± are their sum. “Change”: what the figure moves by when something that is not "
        "known of the diaphragm is taken otherwise; the models share it, and bars leave it out. "
    )
    if seen:
        note += (
            f"Observed orders of the grid, from three: {seen}. Where it is between half of the "
            "order that is expected and twice, the error is 1.25 times Richardson’s, else 3 times."
        )
    return Table(head=["Changed alone", "it is", *COLUMNS.values()], rows=rows, note=note)


def front_table(study: Mapping[str, Any]) -> Table:
    """Every point of speed against error, the fastest first; ● marks the front of a figure."""
    names = [name for name in COLUMNS if not name.endswith("_deg")]
    bars: Errors = study.get("uncertainty") or {}
    rows = []
    for point in sorted(study["points"], key=lambda item: item["wall_s"] or float("inf")):
        name = f"{point['model']}, {RESOLUTIONS.get(point['resolution'], point['resolution'])}"
        costs = [number(point.get(key), "s") for key in ("wall_s", "cpu_s")]
        if point.get("failure"):
            rows.append([name, *costs, "failed", *[""] * (len(names) - 1)])
            continue
        best = (point["model"], point["resolution"]) == (study["reference"], "as_run")
        cells = [
            ("reference" if best else percent(point["error"].get(key)))
            + (" ●" if key in point["on_front"] else "")
            for key in names
        ]
        rows.append([name, *costs, *cells])
    rows.append(["reference’s own error", "", "", *(percent(bars.get(key)) for key in names)])
    return Table(
        head=["Run", "wall time", "CPU time", *(COLUMNS[name] for name in names)],
        rows=rows,
        note="● is on the front: no other run is both faster and closer to the reference. "
        "Where meshes differ, the nodes of the one are interpolated at the moulded places of the "
        f"other’s, which adds some h²/(8 R) to the shape, h the edges’ length. {_TIMES}",
    )


_CHECKS = {
    "similar": "the scene, at a quarter of all lengths, against the scene",
    "small_sway": "small sway, against a sum of sloshing modes",
    "level_sway": "slow sway, against a level surface",
}


def checks_table(study: Mapping[str, Any]) -> Table | None:
    """Short runs of this tank beside what theory says of them; None for a study without any."""
    rows = [
        [
            _CHECKS[one["check"]], one["model"], number(one["frequency_ratio"], digits=2),
            number(one["computed"], digits=4), number(one["theory"], digits=4),
            number(one.get("phase_deg"), "°", digits=2), percent(one["error"]),
        ]
        for one in study.get("checks") or []
    ]  # fmt: skip
    if not rows:
        return None
    return Table(
        head=["Run", "model", "f/f1", "CG over sway", "theory", "phase", "difference"],
        rows=rows,
        note="The phase is that beyond theory’s; the difference is that of the complex amplitude, "
        "phase included. Similar tanks (same Froude and Reynolds numbers, E with the length) move "
        "alike. Theory knows the sheet’s mass in small sway, and nothing of it in slow sway; what "
        "its bending and its rim do is left in the difference, and so is the grid’s error. Folds "
        "are damped in both by a cloth.fold_damping of 1 at the most: more stands for the folds of "
        "violent motion, and makes gentle motion lag.",
    )


_RATIOS = {
    "eq46_as_printed": "hydrostatic over kinetic, thesis Eq. 4.6 as printed",
    "eq46_as_worded": "… by the words of its text",
    "kinetic_ratio": "… measured",
    "unsteady_ratio": "hydrostatic over unsteady, measured",
    "dynamic_fraction": "p* over hydrostatic, rms",
    "neglected_momentum": "momentum that hydrostatics neglects, over the tank’s",
}


def ratios_table(study: Mapping[str, Any]) -> Table | None:
    """Bernoulli's terms in the reference, with its own error; None where it measures none."""
    measured = study.get("bernoulli") or {}
    if not measured:
        return None
    guessed = (study["models"].get(study["reference"]) or {}).get("bernoulli") or {}
    rows = []
    for name, text in _RATIOS.items():
        one = measured.get(name) or {"value": guessed.get(name), "uncertainty": None}
        if one["value"] is not None:
            bar = f" ± {number(one['uncertainty'])}" if one["uncertainty"] is not None else ""
            rows.append([text, number(one["value"]) + bar])
    return Table(
        head=[f"In {study['reference']}", "ratio"],
        rows=rows,
        note="Of the largest values in space and time, but for the last two. Far above 1 the term "
        "may be left out, at 1 or below it may not: Eq. 4.6 guesses the liquid’s speed, and does "
        "not have the unsteady term. ± is the reference’s own error, as above.",
    )


def _own(key: str, reference: str) -> str:
    grid = FLUIDS[reference].coarser_text
    return grid if key == "coarser_grid" else key.replace("_", " ")


def _cell(name: str, value: float | None, bar: float | None, below: bool) -> str:
    def said(one: float | None) -> str:
        return number(one, "°", 2) if name.endswith("_deg") else percent(one)

    text = said(value)
    if value is not None and bar is not None:
        text += f" ± {said(bar)}"
    return f"≈ {text}" if below else text


def times(value: float | None) -> str:
    """Return a speed-up as text; a dash for None."""
    return "–" if value is None else f"{number(value)} ×"
