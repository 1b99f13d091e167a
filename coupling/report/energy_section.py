"""Where the energy goes: a figure over time, and a table by period."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.fluids import FLUIDS
from coupling.metrics.energy import SHARES, rest
from coupling.report.files import RunFiles
from coupling.report.page import Picture, Section, Table, number, percent
from coupling.report.style import BLUE, GREY, INK, ORANGE, legend_above, new_figure, svg, thinned

PARTS = (*SHARES, "rest_J")  # add up to the dissipated
_ROWS = {
    "liquid_J": "… by the liquid",
    "wall_layers_J": "… … of it in laminar layers at the walls, by Stokes’ formula",
    "removed_J": "… … of it taken out by the rule against made energy",
    "stretch_loss_J": "… by the rubber’s own loss as it stretches (loss_factor)",
    "shell_friction_J": "… by friction on the shell (friction_shell)",
    "self_friction_J": "… by the sheet’s friction on itself (friction_self)",
    "bending_damping_J": "… by fold_damping, a regularisation of the sheet’s bending",
    "drag_J": "… by slack_drag, a regularisation of its sliding",
    "rest_J": "… by impacts, snapping taut and the time step",
}


def energy_section(run: RunFiles) -> Section | None:
    """The energy balance of a run; None where its files hold none, or nothing moved."""
    energy = run.summary.get("energy")
    if not energy or not energy["peak_J"] or len(run.results.steps.time) < 2:
        return None
    return Section(
        title="Where the energy goes",
        text="Liquid and diaphragm together, in the tank’s frame, summed over every step: the work "
        "of the tank’s acceleration, or of the datum pressure on liquid that is drawn, less the "
        "energy that is stored, has been dissipated.",
        tables=[energy_table(run)],
        pictures=[_stored(run), _lost(run)],
    )


def energy_table(run: RunFiles) -> Table:
    """Work and dissipation by period, or of the whole run where there is none."""
    energy = run.summary["energy"]
    period = energy["per_period"]
    if period is None:
        drawn = run.scene.supply.drawn
        of = "datum pressure on the drawn volume" if drawn else "tank’s acceleration"
        rows = [
            [f"Work of the {of}", number(energy["work_J"], "J"), ""],
            ["Dissipated", number(energy["dissipated_J"], "J"), ""],
            ["Largest energy stored", number(energy["peak_J"], "J"), ""],
        ]
        return Table(head=["Whole run", "", ""], rows=rows)
    lost = period["dissipated_J"]
    rows = [
        ["Work of the tank’s acceleration", number(period["work_J"], "J"), ""],
        ["Largest energy stored", number(period["peak_J"], "J"), ""],
        ["Dissipated", number(lost, "J"), _of_stored(period["fraction"])],
    ]
    shared = _has_shares(period)
    rows += [
        [text, number(period[name], "J"), percent(period[name] / lost) if shared else ""]
        for name, text in _ROWS.items()
        if period.get(name) is not None
    ]
    head = ["A period", "", "of the dissipated" if shared else ""]
    return Table(head=head, rows=rows, note=_note(run))


def _of_stored(fraction: float | None) -> str:
    """What is dissipated over the largest energy stored: no part of it, so it may be more."""
    if fraction is None:
        return ""
    if abs(fraction) > 1.0:
        return f"{number(fraction)} times the largest stored"
    return f"{percent(fraction)} of the largest stored"


def _has_shares(period: dict[str, Any]) -> bool:
    """Whether the parts of what is dissipated are parts of it: none of them makes energy."""
    removed = period["removed_J"] or 0.0
    layers = period.get("wall_layers_J") or 0.0
    inside = removed, layers, period["liquid_J"] - removed - layers
    parts = (*(period.get(name, 0.0) for name in PARTS), *inside)
    return bool(period["dissipated_J"] > 0.0 and min(parts) >= 0.0)


def _note(run: RunFiles) -> str:
    period = run.summary["energy"]["per_period"]
    layer = period["wall_layer_estimate_J"]
    text = ""
    if not _has_shares(period):
        largest = max(abs(period.get(name, 0.0)) for name in PARTS)
        text = (
            "What is negative makes energy, so that the parts are no shares of the whole: up to "
            f"{number(largest, 'J', 2)} of losses and gains cancel in it. "
        )
    if layer is not None:
        text += (
            f"Laminar boundary layers at the walls would take about {number(layer, 'J', 2)} a "
            "period (Stokes’s estimate, beside the balance). "
        )
    return (text + FLUIDS[run.model].dissipation_note).strip()


def _stored(run: RunFiles) -> Picture:
    """Energies over time."""
    metrics, time = run.results.steps.metrics, run.results.steps.time
    figure = new_figure()
    axes = figure.subplots()
    axes.plot(*thinned(time, metrics["mechanical_energy"]), color=INK, label="all")
    if "kinetic_energy" in metrics:
        axes.plot(*thinned(time, metrics["kinetic_energy"]), "--", color=BLUE, label="flow")
    raised = metrics["liquid_potential_energy"]
    axes.plot(*thinned(time, raised), "-.", color=ORANGE, label="raised liquid")
    axes.set(xlabel="time (s)", ylabel="energy stored (J)")
    legend_above(axes)
    text = "Energy above that at rest: of liquid and diaphragm, of the flow, of the raised liquid."
    return Picture(source=svg(figure), caption=text, alt=text)


def _lost(run: RunFiles) -> Picture:
    """Work and dissipation since the start, over time."""
    metrics, time = run.results.steps.metrics, run.results.steps.time
    figure = new_figure()
    axes = figure.subplots()
    work = metrics["tank_work"] + metrics["datum_work"]
    damped = metrics["dissipated_by_bending"] + metrics["dissipated_by_drag"]
    names = [
        name
        for name in ("stretch", "shell_friction", "self_friction")
        if f"dissipated_by_{name}" in metrics
    ]
    own = sum((metrics[f"dissipated_by_{name}"] for name in names), np.zeros(len(time)))
    curves = (
        ("work", work, GREY, "-"),
        ("dissipated", metrics["dissipated"], INK, "-"),
        ("liquid", metrics["dissipated_by_liquid"], BLUE, "--"),
        ("rubber", own, ORANGE, "-"),
        ("regularisation", damped, ORANGE, "-."),
        ("rest", np.asarray(rest(metrics)), GREY, ":"),
    )
    for label, values, colour, line in curves:
        axes.plot(*thinned(time, values), line, color=colour, label=label)
    axes.set(xlabel="time (s)", ylabel="since the start (J)")
    legend_above(axes, columns=3)
    text = (
        "Work of the tank and what was dissipated, and by what: the liquid, the diaphragm’s own "
        "loss and friction, its regularisations (fold_damping, slack_drag), and the rest (impacts, "
        "snapping taut, time step)."
    )
    return Picture(source=svg(figure), caption=text, alt=text)
