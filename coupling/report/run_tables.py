"""The scene and the run in tables."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from coupling.estimate.strength import strength_verdict
from coupling.report.files import RunFiles
from coupling.report.page import Table, number, percent


def motion_table(run: RunFiles) -> Table:
    """Amplitude and phase of CG, force and moment by component."""
    cg, force = run.summary["cg"], run.summary["force"]
    moment = run.summary.get("moment") or {"amplitude_Nm": [None] * 3, "phase_deg": [None] * 3}
    rows = []
    for axis, name in enumerate("xyz"):
        rows.append(
            [
                name,
                _amplitude(cg["amplitude_m"], axis, 1e3),
                _phase(cg["phase_deg"][axis]),
                _amplitude(force["amplitude_N"], axis),
                _phase(force["phase_deg"][axis]),
                _amplitude(moment["amplitude_Nm"], axis),
                _phase(moment["phase_deg"][axis]),
            ]
        )
    periods = run.summary.get("fitted_periods")
    how = (
        f"First harmonic over the last {_periods(periods)}; the phase is against the tank’s "
        "displacement, negative where it lags. CG in the tank frame."
        if periods
        else "Half the peak-to-peak range: there is no whole period to fit."
    )
    head = ["", *_heads("CG (mm)", cg), *_heads("force (N)", force), "moment (N m)", "phase (°)"]
    note = f"{how} The moment is about the tank’s centre."
    if run.results.steps.tank_rotation.any():
        note += " The tank turns: all of it is in the tank’s own axes, and so are the pictures."
    if cg.get("transient") or force.get("transient"):
        note += (
            " ‡ transient: from the last period but one to the last the harmonic changed by more "
            "than 5 %, or there are no two periods."
        )
    return Table(head=head, rows=rows, note=note)


def _heads(name: str, part: Mapping[str, Any]) -> list[str]:
    """Heads of amplitude and phase; a ‡ marks those of a transient, as the table's note says."""
    return [f"{head} ‡" if part.get("transient") else head for head in (name, "phase (°)")]


def _periods(count: int) -> str:
    return "whole period" if count == 1 else f"{count} whole periods"


def transfer_table(run: RunFiles) -> Table | None:
    """Transfer functions and peaks by component; None where a run's files do not hold them."""
    cg, force = run.summary["cg"].get("transfer"), run.summary["force"].get("transfer")
    if not cg or not force:
        return None
    peak, moment = run.summary["force"]["peak_dynamic_N"], run.summary["moment"]["peak_Nm"]
    rows = [
        [name, _complex(cg, axis), _complex(force, axis), number(peak[axis]), number(moment[axis])]
        for axis, name in enumerate("xyz")
    ]
    return Table(
        head=["", "CG over tank", "force over m a", "peak force (N)", "peak moment (N m)"],
        rows=rows,
        note="First harmonics as complex numbers: the CG’s displacement in the tank over the "
        "tank’s own, and the force on the tank over −m a, which would be 1 for a liquid that "
        "moves as one body with it. Peaks at the ends of steps; the force without the "
        "weight.",
    )


def _complex(ratio: dict[str, Any], axis: int) -> str:
    real, imaginary = ratio["real"][axis], ratio["imag"][axis]
    if real is None:
        return "–"
    text = f"{real:.3f} {'+' if imaginary >= 0.0 else '-'} {abs(imaginary):.3f} i"
    return text.replace("-", "−")


def _amplitude(values: list[float | None], axis: int, scale: float = 1.0) -> str:
    """One component; what is noise beside the largest is 0."""
    known, value = [item for item in values if item is not None], values[axis]
    if value is None:
        return "–"
    return number(scale * value) if value > 1e-5 * max(known) else "0"


def _phase(value: float | None) -> str:
    return "–" if value is None else f"{round(value, 1) + 0.0:.1f}".replace("-", "−")


def cost_table(run: RunFiles) -> Table:
    """Return a table of the wall time by part."""
    summary = run.summary
    total = float(summary["wall_s"]) or 1.0
    parts = {name: float(value) for name, value in summary["wall_by_part"].items()}
    parts["the rest"] = max(0.0, total - sum(parts.values()))
    rows = [[name, number(value, "s"), percent(value / total)] for name, value in parts.items()]
    rows.append(["together", number(summary["wall_s"], "s"), ""])
    return Table(head=["Part", "wall time", "share"], rows=rows)


def quality_table(run: RunFiles) -> Table:
    """Return a table of how well the steps were solved: iterations, strain, errors."""
    summary, coupling = run.summary, run.summary["coupling"]
    cloth = summary.get("cloth", {})
    coupled = [
        ["Scheme", str(coupling["scheme"])],
        ["Iterations a step, mean", number(coupling["iterations_mean"])],
        ["Iterations a step, most", number(coupling["iterations_max"])],
        ["Steps that did not converge", number(coupling["unconverged_steps"])],
    ]
    count = summary.get("halved_steps")
    halved = [["Steps that had to be halved", number(count, digits=6)]] if count else []
    rows = [
        ["Steps", number(summary["steps"], digits=6)],
        *halved,
        *(coupled if run.has_flow else [["Coupling", "none: no flow"]]),
        ["Largest tensile strain", percent(summary["strain_tensile_max"])],
        ["Tensile strain below it in 99 %", percent(summary.get("strain_tensile_p99"))],
        ["Inner iterations of the sheet, mean", number(cloth.get("iterations_mean"))],
        ["Inner iterations of the sheet, most", number(cloth.get("iterations_max"))],
        ["Largest volume error", number(summary["volume_error_max"])],
        *_mesh_rows(summary.get("flow_mesh")),
        ["Force against momentum", percent(summary["force"].get("momentum_imbalance"))],
    ]
    return Table(head=["Quality", ""], rows=rows)


def _mesh_rows(fit: Mapping[str, float] | None) -> list[list[str]]:
    """How far the flow's mesh was from the liquid, where there is one."""
    if fit is None:
        return []
    millimetres = {name: 1e3 * value for name, value in fit.items() if name.endswith("_m")}
    return [
        ["Flow's patch to the diaphragm, rms", number(millimetres["patch_distance_rms_m"], "mm")],
        ["Flow's CG to the liquid's, rms", number(millimetres["cg_offset_rms_m"], "mm")],
        ["Largest non-orthogonality", number(fit["non_orthogonality_max_deg"], "°")],
    ]


def rubber_table(run: RunFiles) -> Table:
    """Return a table of how hard the rubber was pulled."""
    summary, strength = run.summary, run.scene.diaphragm.strength
    stress = summary.get("stress_max_Pa")
    rows = [
        ["Largest tension", number(summary.get("tension_max_N_per_m"), "N/m")],
        ["Largest stress", number(None if stress is None else 1e-6 * stress, "MPa")],
    ]
    if strength is not None:
        rows.append(["Strength of the rubber", number(1e-6 * strength, "MPa")])
    verdict = strength_verdict(run.scene, stress)
    if verdict is not None:
        rows.append(["Would it hold?", verdict])
    return Table(
        head=["Rubber", ""],
        rows=rows,
        note="Tension and stress are the largest of all steps and triangles. They depend on the "
        "step and on the diaphragm’s iterations: compare runs that share both.",
    )
