"""``summary.json``: a run in one small dictionary."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.estimate.strength import strength_verdict, stress_estimate
from coupling.metrics import bernoulli
from coupling.metrics.carrier import carrier_summary
from coupling.metrics.energy import energy_summary
from coupling.metrics.expulsion import expulsion_summary
from coupling.metrics.fold_figures import fold_summary
from coupling.metrics.folds import FoldFinder
from coupling.metrics.gravity_centre import neglected_momentum, neglected_momentum_transient
from coupling.metrics.harmonic import Harmonic
from coupling.metrics.impacts import impacts
from coupling.metrics.mesh_fit import mesh_fit
from coupling.metrics.record import record_statistics
from coupling.metrics.response import (
    cg_summary,
    force_summary,
    harmonics,
    moment_summary,
    shaking_frequency,
)
from coupling.metrics.rubs import rub_summary
from coupling.metrics.strains import quantile
from coupling.metrics.viscosity import layer_resolution
from coupling.scene.scene import Scene
from coupling.store.atomic import plain
from coupling.store.attitude import body_force, in_ground
from coupling.store.results import Results
from coupling.store.run_record import RunStatistics
from coupling.store.step_series import StepSeries

# Kept under this name for programs that read it; ``rubs`` has all.
_RUBBING = ("shell_slip_max_m", "shell_slip_mean_m", "shell_slip_place_deg", "self_slip_max_m")


def summarise(
    results: Results, statistics: RunStatistics, scene: Scene, status: str, error: str | None
) -> dict[str, Any]:
    """Everything of a run that fits into a few numbers, ready for JSON.

    All of it is of every step, whatever ``time.output_every``, but for ``flow_fields_bytes``.

    Amplitudes and phases are those of the first harmonic over the last whole periods, the phase
    against the tank's displacement, or its rotation where its middle stays. CG, force and moment
    are in the tank's axes. A run shorter than a period, or a motion without one, gives
    half the peak-to-peak range and no phase (null). A model without a flow does not know the
    liquid's speed: ``kinetic_ratio`` and ``unsteady_ratio`` are null and ``dynamic_fraction`` 0.
    ``drift``: by how much a phasor changed in the last period (``phasor_drift``); ``transient``:
    whether that is above 0.05, or the run shorter than two periods.
    ``transfer``: the CG over the tank's displacement d, the force over m omega^2 d. Peaks are the
    largest sizes of each component at the ends of steps, ``peak_dynamic_N`` less the weight.
    ``cloth`` counts inner iterations of the solves that parts of steps end with;
    ``strain_tensile_p99`` is what strain stays below in 99 % of area and time.
    ``dynamic_in_band``: rms of p* at up to four times the frequency, over that of the hydrostatic
    pressure, in the fitted periods. ``record``: rms, peaks, level crossings and bands of a motion
    that follows a record (``record_statistics``), null for any other; its ``amplitude`` is half the
    peak-to-peak range. ``impacts``: impulses of the force, null for a motion without a frequency.
    ``carrier``: motion, forces and energies of a free tank, null of any other.
    ``rubs`` is what had gathered at the end (``rub_summary``), ``rubbing`` its former part. What
    cannot be said at all is null.
    """
    series, strength = results.steps, scene.diaphragm.strength
    rubs = rub_summary(results, scene.diaphragm.wear_coefficient)
    fits = harmonics(series, scene)
    periods = fits["cg"].periods if fits else 0
    content: dict[str, Any] = {
        "status": status,
        "model": scene.model.fluid,
        "solver": statistics.flow_solver,
        "flow_fields_bytes": statistics.flow_fields_bytes,
        "steps": statistics.steps,
        "simulated_s": statistics.simulated_s,
        "wall_s": statistics.wall_s,
        "cpu_s": statistics.cpu_s,
        "wall_by_part": dict(statistics.wall_by_part),
        "strain_tensile_max": statistics.strain_tensile_max,
        "strain_tensile_p99": quantile(statistics.strain_areas, 0.99),
        "tension_max_N_per_m": statistics.tension_max,
        "stress_max_Pa": statistics.stress_max,
        "would_burst": None if strength is None else stress_estimate(scene) > strength,
        "strength_verdict": strength_verdict(scene, statistics.stress_max),
        "folds": _folds(results, scene),
        "expulsion": expulsion_summary(series, scene),
        "rubs": rubs,
        "rubbing": {name: rubs[name] for name in _RUBBING},
        "settle_residual": statistics.settle_residual,
        "halved_steps": statistics.halved_steps,
        "volume_error_max": statistics.volume_error_max,
        "coupling": {
            "scheme": scene.coupling.scheme,
            "iterations_mean": statistics.iterations_total / max(statistics.steps, 1),
            "iterations_max": statistics.iterations_max,
            "unconverged_steps": statistics.unconverged_steps,
        },
        "cloth": _cloth(statistics, scene),
        "cg": cg_summary(series, scene, fits),
        "force": force_summary(series, scene, fits),
        "moment": moment_summary(series, fits),
        "bernoulli": _bernoulli(series, statistics, scene, fits),
        "pressure": bernoulli.pressure_split(
            series.metrics, has_flow=statistics.speed_max is not None
        )
        | {"dynamic_in_band": statistics.dynamic_in_band},
        "impacts": _impacts(series, scene),
        "record": record_statistics(series, scene),
        "boundary_layer": layer_resolution(series.metrics, scene.liquid.viscosity, scene.frequency),
        "flow_mesh": mesh_fit(series.metrics),
        "carrier": carrier_summary(series, scene),
        "energy": energy_summary(series, scene.frequency, periods),
        "fitted_periods": periods,
        "error": error,
    }
    cleaned: dict[str, Any] = plain(content)
    return cleaned


def _cloth(statistics: RunStatistics, scene: Scene) -> dict[str, Any]:
    return {
        "tolerance": scene.cloth.tolerance,
        "iterations_mean": statistics.cloth_iterations_total / max(statistics.cloth_solves, 1),
        "iterations_max": statistics.cloth_iterations_max,
        "unconverged_steps": statistics.cloth_unconverged,
        "inextensibility_error": None,  # a study tells, by doubling the stiffness
    }


def _folds(results: Results, scene: Scene) -> dict[str, Any]:
    finder = FoldFinder(results.reference, results.triangles)
    last = results.position[-1] if len(results.time) else None
    return fold_summary(results.steps.time, results.steps.metrics, scene, finder, last)


def _impacts(steps: StepSeries, scene: Scene) -> dict[str, Any] | None:
    frequency = shaking_frequency(steps, scene)
    if frequency is None:
        return None
    return impacts(
        steps.time,
        steps.force,
        body_force=body_force(np.array(scene.gravity), steps),
        mass=scene.liquid.density * scene.liquid_volume,
        frequency=frequency,
    )


def _bernoulli(
    steps: StepSeries, statistics: RunStatistics, scene: Scene, fits: dict[str, Harmonic]
) -> dict[str, float | None]:
    gravity, radius = np.array(scene.gravity), scene.tank.shell.size
    largest = bernoulli.effective_gravity(gravity, steps.tank_acceleration)
    if fits:
        momentum = neglected_momentum(
            fits["cg_in_ground"].coefficient, fits["displacement"].coefficient
        )
    else:
        momentum = neglected_momentum_transient(
            steps.time, in_ground(steps.liquid_cg, steps), steps.tank_acceleration
        )
    return {
        "kinetic_ratio": bernoulli.kinetic_ratio(
            body_force=largest, radius=radius, speed_max=statistics.speed_max
        ),
        "unsteady_ratio": bernoulli.unsteady_ratio(
            body_force=largest, radius=radius, dphi_dt_max=statistics.dphi_dt_max
        ),
        "dynamic_fraction": bernoulli.dynamic_fraction(steps.metrics),
        "neglected_momentum": momentum,
        **bernoulli.thesis_estimates(
            body_force=largest,
            radius=radius,
            frequency=scene.frequency,
        ),
    }
