"""What hydrostatics leaves out: the thesis' estimate beside the measured, and the parts of p*."""

from __future__ import annotations

import numpy as np

from coupling.fluids import FLUIDS
from coupling.metrics.bernoulli import effective_gravity, thesis_estimates
from coupling.metrics.harmonic import BAND
from coupling.report.files import RunFiles
from coupling.report.page import Table, number, percent, ratio


def bernoulli_table(run: RunFiles) -> Table:
    """The thesis' estimate, as printed and by its own words, beside what was measured."""
    scene, figures = run.scene, run.summary["bernoulli"]
    rows = []
    if scene.frequency is not None:
        estimate = thesis_estimates(
            body_force=effective_gravity(
                np.array(scene.gravity), run.results.steps.tank_acceleration
            ),
            radius=scene.tank.shell.size,
            frequency=scene.frequency,
        )
        rows += [
            [
                "Kinetic term, thesis Eq. 4.6 as printed",
                number(estimate["eq46_as_printed"], digits=4),
                "guesses that the liquid moves a quarter of the radius a period",
            ],
            [
                "Kinetic term, Eq. 4.6 by the words of its text",
                number(estimate["eq46_as_worded"], digits=4),
                "the same guess with a quarter of the diameter: four times less",
            ],
        ]
    rows += [
        [
            "Kinetic term, measured",
            ratio(figures["kinetic_ratio"]),
            "with the largest speed that this run found: what Eq. 4.6 is after",
        ],
        [
            "Unsteady term, measured",
            ratio(figures["unsteady_ratio"]),
            "with the largest ∂φ/∂t: the added mass, which Eq. 4.6 does not have",
        ],
    ]
    return Table(
        head=["Hydrostatic pressure over …", "ratio", "what it says"],
        rows=rows,
        numbers=False,
        note="ρ|g − a|R over the largest value of the term in the run. Far above 1, hydrostatics "
        "may leave the term out; about 1 or below, it may not. In the thesis’ own example, 1 Hz "
        "and 12 inches, Eq. 4.6 gives 1118 and 279.5. A dash: this model has no flow to measure.",
    )


_PARTS = {
    "dynamic": "p*, all that hydrostatics leaves out",
    "unsteady": "… its unsteady part −ρ∂φ/∂t",
    "kinetic": "… its kinetic part −ρ|u|²/2",
    "viscous": "Viscous stress on the diaphragm",
}


def split_table(run: RunFiles) -> Table | None:
    """The parts of p* against the hydrostatic pressure; None where the results hold no p*."""
    pressure, layer = run.summary.get("pressure"), run.summary.get("boundary_layer")
    if not pressure or not layer or pressure["dynamic_rms_Pa"] is None:
        return None
    whole = pressure["hydrostatic_rms_Pa"]
    rows = [["Hydrostatic pressure", number(whole, "Pa"), "", ""]]
    for part, text in _PARTS.items():
        value = pressure[f"{part}_rms_Pa"]
        if part == "viscous" and not FLUIDS[run.model].has_viscosity:
            rows.append([text, "none in this model", "", ""])
        elif value is not None:
            share = percent(value / whole) if whole else "–"
            rows.append([text, number(value, "Pa"), share, percent(pressure.get(f"{part}_median"))])
    band = pressure.get("dynamic_in_band")
    if band is not None:
        text = f"p* at up to {BAND} times the frequency, in the fitted periods"
        rows.insert(2, [text, "", percent(band), ""])
    return Table(
        head=["rms over the diaphragm", "and over time", "of hydrostatic", "its median over time"],
        rows=rows,
        note="Means over the diaphragm removed. Impacts weigh in the rms over time, not in the "
        "median. " + _how(run, layer),
    )


def impulse_sentence(run: RunFiles) -> str:
    """The largest impulse of the force; empty for a run without a frequency or an impulse."""
    found = run.summary.get("impacts")
    if not found or not found["number"]:
        return ""
    many = "once" if found["number"] == 1 else f"{found['number']} times"
    return (
        f"The largest impulse beyond a rigid liquid’s within an eighth of a period is "
        f"{number(found['impulse_max_Ns'], 'N s')}, at {number(found['time_of_max_s'], 's')}; half "
        f"of it or more is met {many}. It hangs less on the step than the force’s peak."
    )


def _how(run: RunFiles, layer: dict[str, float | None]) -> str:
    model = FLUIDS[run.model]
    text = model.pressure_note
    if not model.has_viscosity:
        return text
    if layer["cells_in_layer"] is None or layer["stokes_layer_m"] is None:
        return text
    return text + (
        f" A laminar layer would be {number(1e3 * layer['stokes_layer_m'], 'mm', 2)} thick, "
        f"{number(layer['cells_in_layer'], digits=2)} of the cells at the walls: this mesh does "
        "not show it, and the stress is by about that factor too small."
        if layer["cells_in_layer"] < 1.0
        else f" The laminar layer spans {number(layer['cells_in_layer'], digits=2)} cells."
    )
