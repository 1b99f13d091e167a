"""``summary.json``: a run in one small dictionary."""

from __future__ import annotations

from typing import Any

import numpy as np

from coupling.estimate.strength import strength_verdict, stress_estimate
from coupling.metrics import bernoulli
from coupling.metrics.energy import energy_summary
from coupling.metrics.forces import momentum_imbalance
from coupling.metrics.gravity_centre import (
    neglected_momentum,
    neglected_momentum_transient,
    peak_amplitude,
)
from coupling.metrics.harmonic import (
    Harmonic,
    first_harmonic,
    last_whole_periods,
    phasor_drift,
)
from coupling.metrics.mesh_fit import mesh_fit
from coupling.metrics.rubs import rub
from coupling.metrics.strains import quantile
from coupling.metrics.transfer import tank_phasor, transfer
from coupling.metrics.viscosity import layer_resolution
from coupling.ports import Array
from coupling.scene.scene import Scene
from coupling.store.atomic import plain
from coupling.store.results import Results
from coupling.store.run_record import RunStatistics


def summarise(
    results: Results, statistics: RunStatistics, scene: Scene, status: str, error: str | None
) -> dict[str, Any]:
    """Everything of a run that fits into a few numbers, ready for JSON.

    Amplitudes and phases are those of the first harmonic over the last whole periods, the phase
    against the tank's displacement. A run shorter than a period, or a motion without one, gives
    half the peak-to-peak range and no phase (null). A model without a flow does not know the
    liquid's speed: ``kinetic_ratio`` and ``unsteady_ratio`` are null and ``dynamic_fraction`` 0.
    ``drift``: by how much a phasor changed in the last period (``phasor_drift``).
    ``transfer``: the CG over the tank's displacement d, the force over m omega^2 d. Peaks are the
    largest sizes of each component at the instants written out, ``peak_dynamic_N`` less the weight.
    ``cloth`` counts inner iterations of the solves that parts of steps end with;
    ``strain_tensile_p99`` is what strain stays below in 99 % of area and time.
    ``rubbing`` is what had gathered at the last instant, null where nothing slid. What cannot be
    said at all is null.
    """
    fits, strength = harmonics(results, scene), scene.diaphragm.strength
    periods = fits["cg"].periods if fits else 0
    weight = scene.liquid.density * scene.liquid_volume * np.array(scene.gravity)
    steps = max(statistics.steps, 1)
    content: dict[str, Any] = {
        "status": status,
        "model": scene.model.fluid,
        "solver": statistics.flow_solver,
        "flow_fields_bytes": statistics.flow_fields_bytes,
        "steps": statistics.steps,
        "simulated_s": statistics.simulated_s,
        "wall_s": statistics.wall_s,
        "wall_by_part": dict(statistics.wall_by_part),
        "strain_tensile_max": statistics.strain_tensile_max,
        "strain_tensile_p99": quantile(statistics.strain_areas, 0.99),
        "tension_max_N_per_m": statistics.tension_max,
        "stress_max_Pa": statistics.stress_max,
        "would_burst": None if strength is None else stress_estimate(scene) > strength,
        "strength_verdict": strength_verdict(scene, statistics.stress_max),
        "rubbing": _rubbing(results),
        "settle_residual": statistics.settle_residual,
        "halved_steps": statistics.halved_steps,
        "volume_error_max": statistics.volume_error_max,
        "coupling": {
            "scheme": scene.coupling.scheme,
            "iterations_mean": statistics.iterations_total / steps,
            "iterations_max": statistics.iterations_max,
            "unconverged_steps": statistics.unconverged_steps,
        },
        "cloth": _cloth(statistics, scene),
        "cg": _moving(results.liquid_cg, fits, "cg", "m")
        | {"mean_m": _mean(results.liquid_cg, fits), "transfer": _transfer(fits, "cg")}
        | {"drift": _drift(results.time, results.liquid_cg, scene)},
        "force": _moving(results.force, fits, "force", "N")
        | {"momentum_imbalance": _imbalance(results, scene, periods)}
        | {"drift": _drift(results.time, results.force, scene)}
        | {"peak_N": _peak(results.force), "peak_dynamic_N": _peak(results.force - weight)}
        | {"transfer": _transfer(fits, "force", inertia=_inertia(scene))},
        "moment": _moving(results.moment, fits, "moment", "Nm")
        | {"peak_Nm": _peak(results.moment)},
        "bernoulli": _bernoulli(results, statistics, scene, fits),
        "pressure": bernoulli.pressure_split(
            results.metrics, has_flow=statistics.speed_max is not None
        ),
        "boundary_layer": layer_resolution(results, scene.liquid.viscosity, scene.frequency),
        "flow_mesh": mesh_fit(results.metrics),
        "energy": energy_summary(results, scene.frequency, periods),
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


def _rubbing(results: Results) -> dict[str, Any]:
    shell = itself = None
    if len(results.time):
        shell = rub(results.shell_slip[-1], results.reference, results.triangles)
        itself = rub(results.self_slip[-1], results.reference, results.triangles)
    return {
        "shell_slip_max_m": shell and shell.largest,
        "shell_slip_mean_m": shell and shell.mean,
        "shell_slip_place_deg": shell and shell.place,
        "self_slip_max_m": itself and itself.largest,
    }


def harmonics(results: Results, scene: Scene) -> dict[str, Harmonic]:
    """First harmonics of ``cg``, ``force``, ``moment`` and the tank's ``displacement``.

    Empty where there is no period, or no whole one in the results.
    """
    frequency = scene.frequency
    if frequency is None:
        return {}
    ramp = scene.motion.ramp / frequency
    chosen, periods = last_whole_periods(results.time, frequency, start=ramp)
    if periods == 0:
        return {}
    signals = {
        "cg": results.liquid_cg,
        "force": results.force,
        "moment": results.moment,
        "displacement": results.tank_displacement,
    }
    return {
        name: first_harmonic(results.time[chosen], signal[chosen], frequency, periods=periods)
        for name, signal in signals.items()
    }


def _moving(signal: Array, fits: dict[str, Harmonic], name: str, unit: str) -> dict[str, Any]:
    if fits:
        tank = fits["displacement"].coefficient
        reference = complex(tank[np.argmax(np.abs(tank))])
        return {
            f"amplitude_{unit}": fits[name].amplitude,
            "phase_deg": fits[name].phase_deg(reference),
        }
    amplitude = peak_amplitude(signal) if len(signal) > 1 else [None] * 3
    return {f"amplitude_{unit}": amplitude, "phase_deg": [None] * 3}


def _transfer(fits: dict[str, Harmonic], name: str, inertia: float = 1.0) -> dict[str, Any] | None:
    """Of ``name`` over ``inertia`` times the tank's displacement; None without a period."""
    if not fits:
        return None
    return transfer(fits[name], inertia * tank_phasor(fits["displacement"].coefficient))


def _inertia(scene: Scene) -> float:
    """m omega^2 [N/m] of the liquid."""
    mass = scene.liquid.density * scene.liquid_volume
    return mass * (2.0 * np.pi * (scene.frequency or 0.0)) ** 2


def _peak(signal: Array) -> Any:
    return np.abs(signal).max(axis=0) if len(signal) else [None] * 3


def _mean(signal: Array, fits: dict[str, Harmonic]) -> Any:
    if fits:
        return fits["cg"].mean
    return signal.mean(axis=0) if len(signal) else [None] * 3


def _drift(time: Array, signal: Array, scene: Scene) -> float | None:
    return phasor_drift(time, signal, scene.frequency) if scene.frequency else None


def _imbalance(results: Results, scene: Scene, periods: int) -> float | None:
    if not scene.frequency:
        return None
    return momentum_imbalance(
        results.time,
        force=results.force,
        cg=results.liquid_cg,
        acceleration=results.tank_acceleration,
        gravity=np.array(scene.gravity),
        mass=scene.liquid.density * scene.liquid_volume,
        frequency=scene.frequency,
        periods=periods,
    )


def _bernoulli(
    results: Results, statistics: RunStatistics, scene: Scene, fits: dict[str, Harmonic]
) -> dict[str, float | None]:
    gravity, radius = np.array(scene.gravity), scene.tank.shell.size
    body_force = bernoulli.effective_gravity(gravity, results.tank_acceleration)
    if fits:
        momentum = neglected_momentum(fits["cg"].coefficient, fits["displacement"].coefficient)
    else:
        momentum = neglected_momentum_transient(
            results.time, results.liquid_cg, results.tank_acceleration
        )
    return {
        "kinetic_ratio": bernoulli.kinetic_ratio(
            body_force=body_force, radius=radius, speed_max=statistics.speed_max
        ),
        "unsteady_ratio": bernoulli.unsteady_ratio(
            body_force=body_force, radius=radius, dphi_dt_max=statistics.dphi_dt_max
        ),
        "dynamic_fraction": bernoulli.dynamic_fraction(
            position=results.position,
            triangles=results.triangles,
            dynamic_pressure=results.dynamic_pressure,
            body_force=gravity - results.tank_acceleration,
            density=scene.liquid.density,
        ),
        "neglected_momentum": momentum,
        **bernoulli.thesis_estimates(
            body_force=body_force,
            radius=radius,
            frequency=scene.frequency,
        ),
    }
