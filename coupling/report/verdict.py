"""The sentence on top: how wrong the hydrostatic assumption is."""

from __future__ import annotations

from typing import Any

from coupling.estimate.numbers import numbers_of
from coupling.motion.shaking import moves
from coupling.report.files import RunFiles
from coupling.report.page import number, percent, ratio

ENOUGH = 0.05


def verdict(run: RunFiles) -> tuple[str, str]:
    """Headline and explanation for a run."""
    figures = run.summary["bernoulli"]
    momentum, dynamic = figures["neglected_momentum"], figures["dynamic_fraction"]
    drawn = run.summary.get("expulsion")
    if drawn is not None:
        return _of_expulsion(run, drawn)
    if not moves(run.scene):
        return (
            "The tank is at rest: the pressure is hydrostatic.",
            "There is no motion against which the assumption could fail.",
        )
    if momentum is None:
        return (
            "Too little was computed to judge the hydrostatic assumption.",
            "It takes some instants of a moving tank.",
        )
    if not run.has_flow:
        return _of_hydrostatics(run, momentum)
    return _headline(momentum, dynamic or 0.0), (
        f"The liquid's centre of gravity accelerates within the tank at {percent(momentum)} of the "
        "tank's own acceleration, and hydrostatics holds no force for that. "
        f"The pressure left out is {percent(dynamic)} (rms) of the hydrostatic pressure's "
        f"variation over the diaphragm{_median(run)}." + _shortness(run)
    )


def _of_expulsion(run: RunFiles, found: dict[str, Any]) -> tuple[str, str]:
    """What the diaphragm takes of the gas's pressure while liquid is drawn, and what stays."""
    residual = found["outlet_covered_at_fill"]
    stays = "the outlet stays open"
    if residual is not None:
        stays = f"the diaphragm covers the outlet at {percent(residual)}"
    return (
        f"Drawn from {percent(run.scene.liquid.fill_fraction)} to "
        f"{percent(found['fill_fraction_end'])} of the tank: {stays}.",
        f"The diaphragm takes {number(found['pressure_drop_max_Pa'], 'Pa')} of the gas’s pressure "
        f"at the most, {number(found['pressure_drop_mean_Pa'], 'Pa')} in the mean over the drawn "
        "volume.",
    )


def _median(run: RunFiles) -> str:
    """The same in the median over time, which impacts do not move; empty where it is not known."""
    median = (run.summary.get("pressure") or {}).get("dynamic_median")
    return "" if median is None else f", {percent(median)} in the median over time"


def _headline(momentum: float, dynamic: float) -> str:
    """Whether hydrostatics holds, by the figures that say so."""
    shares = {
        f"{percent(momentum)} of the liquid's momentum": momentum,
        f"{percent(dynamic)} (rms) of the pressure's variation": dynamic,
    }
    failed = [text for text, share in shares.items() if share >= ENOUGH]
    if failed:
        return f"Hydrostatics fails here: it leaves out {' and '.join(failed)}."
    return f"Hydrostatics holds here: it leaves out {percent(max(momentum, dynamic))} at the most."


def _shortness(run: RunFiles) -> str:
    if run.scene.frequency is None or run.summary.get("fitted_periods"):
        return ""
    return " There is no whole period yet: the largest accelerations are compared."


def _of_hydrostatics(run: RunFiles, momentum: float) -> tuple[str, str]:
    headline = (
        f"This run assumes hydrostatic pressure and contradicts it: {percent(momentum)} of the "
        "liquid's momentum is unaccounted for."
        if momentum >= ENOUGH
        else f"This run assumes hydrostatic pressure; {percent(momentum)} of the liquid's momentum "
        "is unaccounted for."
    )
    rule = ""
    if run.summary.get("record") is None:
        expected = numbers_of(run.scene).hydrostatic_error
        rule = (
            f" The rule (f/f₁)² expects the neglected pressure at {percent(expected)} of the "
            "hydrostatic variation."
        )
    return headline, (
        "The centre of gravity that it finds accelerates within the tank, which would take a "
        f"force that its pressure does not hold.{rule} Only a model with a flow measures the rest."
    )


def bernoulli_keys(run: RunFiles) -> list[tuple[str, str, str]]:
    """The key figures under the verdict: name, value, remark."""
    drawn = run.summary.get("expulsion")
    if drawn is not None:
        return _expulsion_keys(drawn)
    figures = run.summary["bernoulli"]
    dynamic, unknown = figures["dynamic_fraction"] if run.has_flow else None, "no flow to measure"
    measured = "measured" if run.has_flow else unknown
    return [
        ("Neglected momentum", percent(figures["neglected_momentum"]), "c″ over the tank’s own"),
        ("Dynamic over hydrostatic pressure", percent(dynamic), "rms" if run.has_flow else unknown),
        _cg_key(run),
        ("Hydrostatic over unsteady term", ratio(figures["unsteady_ratio"]), measured),
    ]


def _expulsion_keys(found: dict[str, Any]) -> list[tuple[str, str, str]]:
    """The key figures of a tank that is drawn empty."""
    at, damped = found["pressure_drop_max_at_fill"], found["pressure_drop_damping_Pa"]
    residual = found["residual_volume_m3"]
    left = number(None if residual is None else 1e3 * residual, "l")
    return [
        ("Largest pressure drop", number(found["pressure_drop_max_Pa"], "Pa"), f"at {percent(at)}"),
        (
            "Mean pressure drop",
            number(found["pressure_drop_mean_Pa"], "Pa"),
            f"{number(damped, 'Pa', 2)} of it by damping",
        ),
        ("Liquid left when the outlet is covered", left, "" if residual else "it stays open"),
        ("Work of the drop", number(found["work_J"], "J"), ""),
    ]


def _cg_key(run: RunFiles) -> tuple[str, str, str]:
    """The CG's amplitude; of a run by a record, which has none, its rms and peak."""
    record = run.summary.get("record")
    if record is not None:
        found = record["signals"]["cg"]
        axis = found["rms"].index(max(found["rms"]))
        peak = number(1e3 * found["peak"][axis], "mm")
        return "CG in the tank, rms", number(1e3 * found["rms"][axis], "mm"), f"peak {peak}"
    cg = run.summary["cg"]["amplitude_m"]
    transient = "transient" if run.summary["cg"].get("transient") else ""
    largest = None if None in cg else 1e3 * max(cg)
    return "CG amplitude in the tank", number(largest, "mm"), transient
