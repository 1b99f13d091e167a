"""Tables that the command line prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from coupling.cli.expulsion_rows import expulsion_rows
from coupling.cli.plain_table import figure, print_table
from coupling.cli.record_tables import print_bands, record_rows
from coupling.cli.rubber_rows import rubber_rows
from coupling.estimate.cost import run_memory, run_time
from coupling.estimate.model_errors import Choice, estimates
from coupling.estimate.numbers import Numbers
from coupling.estimate.strength import burst_warning
from coupling.fluids import FLUIDS
from coupling.motion.record_summary import RecordSummary
from coupling.scene.scene import Scene
from coupling.scene.supply import drawing
from coupling.verify import VerifyResult


def _ratio(value: Any) -> str:
    """A ratio to what may vanish: beyond a million it says no more than that."""
    return figure(value) if value is None or value <= 1e6 else "> 1e6"


def print_summary(summary: Mapping[str, Any], folder: Path) -> None:
    """The main figures of a run's ``summary.json`` and where the results are."""
    coupling, cg = summary.get("coupling") or {}, summary.get("cg") or {}
    bernoulli, mark = summary.get("bernoulli") or {}, ", transient" if cg.get("transient") else ""
    impacts = summary.get("impacts") or {}
    period = (summary.get("energy") or {}).get("per_period") or {}
    rows = [
        ("status", summary.get("status")),
        ("model", summary.get("model")),
        ("simulated time [s]", summary.get("simulated_s")),
        ("largest tensile strain", summary.get("strain_tensile_max")),
        ("... below it in 99 % of area and time", summary.get("strain_tensile_p99")),
        ("largest volume error", summary.get("volume_error_max")),
        ("iterations a step, mean", coupling.get("iterations_mean")),
        ("iterations a step, most", coupling.get("iterations_max")),
        ("unconverged steps", coupling.get("unconverged_steps")),
        *_motion_rows(summary, mark),
        ("hydrostatic over kinetic, thesis Eq. 4.6", _ratio(bernoulli.get("eq46_as_printed"))),
        ("... by the words of its text", _ratio(bernoulli.get("eq46_as_worded"))),
        ("... as measured", _ratio(bernoulli.get("kinetic_ratio"))),
        ("hydrostatic over unsteady, measured", _ratio(bernoulli.get("unsteady_ratio"))),
        ("dynamic over hydrostatic, rms", bernoulli.get("dynamic_fraction")),
        ("... median over time", (summary.get("pressure") or {}).get("dynamic_median")),
        ("largest impulse in an eighth of a period [N s]", impacts.get("impulse_max_Ns")),
        ("momentum that hydrostatics neglects", bernoulli.get("neglected_momentum")),
        ("work done a period [J]", period.get("work_J")),
        ("dissipated a period [J]", period.get("dissipated_J")),
        ("... over the peak energy", period.get("fraction")),
        ("... by the liquid [J]", period.get("liquid_J")),
        ("... by the rubber's stretch [J]", period.get("stretch_loss_J")),
        ("... by friction on the shell [J]", period.get("shell_friction_J")),
        ("... by friction on itself [J]", period.get("self_friction_J")),
        ("... by fold_damping, a regularisation [J]", period.get("bending_damping_J")),
        ("... by slack_drag, a regularisation [J]", period.get("drag_J")),
        ("... by impacts and the time step [J]", period.get("rest_J")),
        *expulsion_rows(summary),
        *rubber_rows(summary),
        ("wall time [s]", summary.get("wall_s")),
        ("results", str(folder)),
    ]
    if summary.get("flow_fields_bytes") is not None:
        size = f"{1e-6 * summary['flow_fields_bytes']:.1f} MB in {folder / 'foam' / 'case.foam'}"
        rows.append(("flow fields", size))
    if (folder / "report.html").is_file():
        rows.append(("report", str(folder / "report.html")))
    print_table("", ("", "value"), [(name, figure(value)) for name, value in rows])
    if summary.get("record"):
        print_bands(summary["record"])
    rubber = summary.get("strength_verdict")
    if rubber and not rubber.startswith("Yes"):
        print(f"Would the rubber hold? {rubber}")


def _motion_rows(summary: Mapping[str, Any], mark: str) -> list[tuple[str, Any]]:
    """How far the CG moved; of a run by a record, which has no amplitude, rms and peaks."""
    record, cg = summary.get("record"), summary.get("cg") or {}
    if record:
        return record_rows(record)
    return [
        ("CG amplitude [m]", figure(cg.get("amplitude_m")) + mark),
        ("CG phase [deg]", figure(cg.get("phase_deg")) + mark),
    ]


def model_estimates(scene: Scene) -> dict[str, dict[str, Any]]:
    """Estimated relative error of the CG motion, wall time [s] and memory of each model.

    ``wall_s``: shortest and longest, see ``run_time``; ``memory_bytes``: see ``run_memory``.
    """
    return {
        name: {
            **asdict(error),
            "wall_s": list(run_time(scene, name)),
            "memory_bytes": run_memory(scene, name),
        }
        for name, error in estimates(scene).items()
    }


def print_check(
    scene: Scene, numbers: Numbers, choice: Choice, record: RecordSummary | None
) -> None:
    """Dimensionless numbers, model errors and costs of a scene."""
    names = {
        "level": "level h/R",
        "slosh_frequency": "first slosh frequency f1 [Hz]",
        "frequency": "driving frequency f [Hz]",
        "frequency_ratio": "f/f1",
        "hydrostatic_error": "neglected by hydrostatics: (f/f1)^2",
        "acceleration_ratio": "largest acceleration over gravity",
        "bond": "Bond number",
        "weber": "Weber number",
        "froude": "Froude number",
        "largest_body_force": "largest body force b [m/s^2]",
        "membrane_parameter": "rho b R^2/(E t)",
        "elasto_gravity_wavelength": "elasto-gravity wavelength [m]",
        "folds_round_the_rim": "folds round the rim",
        "grid_spacing": "spacing of the cloth's grid [m]",
        "rings_to_resolve": "rings that resolve the folds",
        "wrinkling_allowed": "finest wrinkling on this grid",
        "added_mass_ratio": "added over diaphragm mass",
    }
    values = numbers.to_dict()
    rows = [(text, figure(values[key])) for key, text in names.items()]
    if scene.model.fluid in FLUIDS:
        sizes = FLUIDS[scene.model.fluid].size(scene)
        rows += [(text, figure(size)) for text, size in sizes.items()]
    print_table(scene.title, ("number", "value"), rows)
    expected = [
        (
            name,
            figure(row["expected"], 2),
            figure(row["upper"], 2),
            ", ".join(row["outside"]) or "-",
            " to ".join(f"{seconds:.{int(seconds < 10.0)}f}" for seconds in row["wall_s"]),
            f"{1e-6 * row['memory_bytes']:.0f}",
        )
        for name, row in model_estimates(scene).items()
    ]
    heads = (
        "fluid model", "error of the CG motion", "nine in ten below", "beyond the data",
        "wall time [s]", "memory [MB]",
    )  # fmt: skip
    print_table("estimates", heads, expected)
    print(
        "Wall times are those of one free core as fast as this machine's at its best; where others "
        "compute too, or the rubber slams often, they are longer. A report takes some 50 MB more."
    )
    models = [scene.model.fluid] if scene.model.fluid in FLUIDS else list(FLUIDS)
    size = max(FLUIDS[name].fields_size(scene) for name in models)
    if size:
        print(f"The flow's fields will take about {1e-6 * size:.2g} MB in foam/.")
    left_out = ", which inextensibility leaves out" if scene.diaphragm.inextensible else ""
    print(
        f"rho b R^2/(E t): a strain of about {numbers.membrane_parameter:.2g} where the diaphragm "
        f"is taut{left_out}."
    )
    if record is not None:
        print(f"{record.says}.")
        for warning in record.warnings:
            print(f"warning: {warning}")
    for said in (burst_warning(scene), scene.time.beyond, drawing(scene)):
        if said:
            print(said)
    print(f"advised: {choice.fluid} (the scene says {scene.model.fluid}). {choice.reason}.")


def print_verify(results: Sequence[VerifyResult], failures: Mapping[str, str]) -> None:
    """Computed beside exact, one row a quantity; failed cases last."""
    rows = [
        (
            result.case,
            quantity.name,
            figure(quantity.computed, 7),
            figure(quantity.exact, 7),
            figure(quantity.error, 2),
            quantity.unit,
        )
        for result in results
        for quantity in result.quantities
    ]
    rows += [(case, "failed", "-", "-", "-", "-") for case in failures]
    print_table("", ("case", "quantity", "computed", "exact", "error", "unit"), rows)
