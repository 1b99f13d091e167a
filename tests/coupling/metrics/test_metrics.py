"""Metrics against signals and pressure fields with exact answers."""

from __future__ import annotations

import known_run as run
import numpy as np
import pytest

from coupling.metrics import bernoulli
from coupling.metrics.forces import momentum_imbalance
from coupling.metrics.gravity_centre import neglected_momentum, neglected_momentum_transient
from coupling.metrics.harmonic import (
    Harmonic,
    first_harmonic,
    last_whole_periods,
    phasor_drift,
)
from coupling.metrics.transfer import tank_phasor, transfer
from coupling.metrics.viscosity import stokes_layer
from coupling.simulation.sampling import NodePressures, split_metrics

ROUNDING = 1e-12


def signal(time: np.ndarray, frequency: float) -> np.ndarray:
    angle = 2.0 * np.pi * frequency * time
    return np.stack(
        [3.0 + 2.0 * np.cos(angle + 0.4), 0.5 * np.sin(angle), np.full_like(time, 7.0)], 1
    )


def test_an_exact_signal_at_uneven_instants_is_found_to_rounding() -> None:
    time = np.sort(np.random.default_rng(3).uniform(0.0, 2.0, 60))
    fit = first_harmonic(time, signal(time, 1.7), 1.7, periods=3)
    assert fit.amplitude == pytest.approx([2.0, 0.5, 0.0], abs=ROUNDING)
    assert fit.mean == pytest.approx([3.0, 0.0, 7.0], abs=ROUNDING)
    lags = fit.phase_deg(np.exp(-0.5j * np.pi))  # against a sine
    assert lags[0] == pytest.approx(90.0 + np.degrees(0.4), abs=1e-9)
    assert lags[1] == pytest.approx(0.0, abs=1e-9)
    assert lags[2] is None


def test_higher_harmonics_leave_nothing_over_whole_periods() -> None:
    time = np.arange(40) / 40.0
    third = signal(time, 1.0) + np.cos(6.0 * np.pi * time)[:, None]
    fit = first_harmonic(time, third, 1.0, periods=1)
    assert fit.amplitude == pytest.approx([2.0, 0.5, 0.0], abs=ROUNDING)


def test_noise_errs_as_the_docstring_says() -> None:
    random = np.random.default_rng(5)
    time = np.arange(200) / 50.0
    errors = []
    for _ in range(300):
        noise = 0.1 * random.standard_normal((len(time), 1))
        fit = first_harmonic(time, 2.0 * np.cos(2 * np.pi * time)[:, None] + noise, 1.0, periods=4)
        errors.append(fit.amplitude[0] - 2.0)
    # the standard deviation of 300 draws is itself known to 1/sqrt(600) = 4 %: five times that
    assert np.std(errors) == pytest.approx(0.1 * np.sqrt(2.0 / len(time)), rel=0.2)


@pytest.mark.parametrize(
    ("end", "start", "periods"), [(10.0, 1.0, 4), (2.2, 1.0, 1), (1.5, 1.0, 1), (0.9, 0.0, 0)]
)
def test_the_later_half_of_the_whole_periods_is_fitted(
    end: float, start: float, periods: int
) -> None:
    time = np.arange(0.0, end + 1e-9, 0.05)
    chosen, counted = last_whole_periods(time, 1.0, start=start)
    assert counted == periods
    assert chosen.sum() == 20 * periods


def test_too_few_instants_are_not_fitted() -> None:
    assert last_whole_periods(np.array([0.0, 1.0, 2.0, 3.0, 4.0]), 1.0)[1] == 0
    assert last_whole_periods(np.zeros(0), 1.0)[1] == 0


def test_a_phasor_drifts_by_what_its_last_period_added() -> None:
    time = np.linspace(0.0, 2.0, 81)
    wave = np.cos(2.0 * np.pi * time)[:, None] * [3.0, 4.0]
    assert phasor_drift(time, wave, 1.0) == pytest.approx(0.0, abs=ROUNDING)
    # The fit is linear: 1.25 times as large in the last period, by a fifth of what it is there.
    louder = np.where(time > 1.0 + 1e-9, 1.25, 1.0)[:, None] * wave
    assert phasor_drift(time, louder, 1.0) == pytest.approx(0.2)
    assert phasor_drift(time[1:], wave[1:], 1.0) is None
    assert phasor_drift(time[::10], wave[::10], 1.0) is not None
    assert phasor_drift(time[::20], wave[::20], 1.0) is None  # two instants a period
    assert phasor_drift(time, 0.0 * wave, 1.0) is None


def test_neglected_momentum_is_the_ratio_of_the_amplitudes_along_the_shaking() -> None:
    tank = np.array([0.25, 0.0, 0.0], dtype=complex)
    assert neglected_momentum(np.array([0.05j, 1.0, 0.0]), tank) == pytest.approx(0.2)
    assert neglected_momentum(np.ones(3, dtype=complex), 0.0 * tank) is None


def test_a_transient_compares_the_largest_accelerations() -> None:
    time = np.linspace(0.0, 1.0, 401)
    cg = np.stack([0.01 * np.sin(20.0 * time), 0 * time, 0 * time], axis=1)
    tank = np.stack([5.0 * np.cos(time), 0 * time, 0 * time], axis=1)
    # a second difference errs by (omega h)^2/12 = 2e-4
    assert neglected_momentum_transient(time, cg, tank) == pytest.approx(0.8, rel=1e-3)
    assert neglected_momentum_transient(time[:2], cg[:2], tank[:2]) is None
    assert neglected_momentum_transient(time, cg, 0.0 * tank) is None


@pytest.mark.parametrize("decay", [0.0, 3.0], ids=["periodic", "transient"])
def test_a_force_that_obeys_newton_has_no_imbalance(decay: float) -> None:
    """Also in a beat of two frequencies that dies out, where phasors would not agree."""
    time = np.linspace(0.0, 1.6, 161)
    gravity, along = np.array([0.0, 0.0, -9.81]), np.array([1.0, 0.5, 0.0])
    acceleration = np.outer(10.0 * np.sin(2.5 * np.pi * time), along)
    rate = -decay + 1j * 1.3 * 2.5 * np.pi
    free = 0.05 * np.exp(rate * time)
    cg = np.outer(free.real, along)
    force = 200.0 * (gravity - acceleration - np.outer((rate**2 * free).real, along))
    values = {
        "cg": cg, "acceleration": acceleration, "gravity": gravity, "mass": 200.0,
        "frequency": 1.25, "periods": 2,
    }  # fmt: skip
    # The trapezoidal rule on a window that is smooth to its third derivative: (omega h)^4 = 4e-5.
    assert momentum_imbalance(time, force=force, **values) == pytest.approx(0.0, abs=4e-5)
    # A force that leaves out c'' errs by all of it, and one ten per cent too large by a tenth.
    weight = 200.0 * gravity
    larger = weight + (force - weight) / 0.9
    assert momentum_imbalance(time, force=larger, **values) == pytest.approx(0.1, abs=4e-5)
    hydrostatic = 200.0 * (gravity - acceleration)
    assert momentum_imbalance(time, force=hydrostatic, **values) > 0.05
    assert momentum_imbalance(time, force=0.0 * force + weight, **values) is None
    assert momentum_imbalance(time, force=force, **(values | {"periods": 0})) is None


def test_node_areas_add_up_to_the_surface() -> None:
    points, triangles = run.disc(24)
    areas = bernoulli.node_areas(points[None], triangles)
    # a polyhedron inscribed in a hemisphere: O(h^2), h = 1/24 of a quarter turn
    assert areas.sum() == pytest.approx(2.0 * np.pi * run.RADIUS**2, rel=(np.pi / 48.0) ** 2)


def test_the_dynamic_fraction_of_a_linear_pressure_is_the_ratio_of_its_slopes() -> None:
    points, triangles = run.disc()
    found = []
    for position in (points, 0.9 * points):
        hydrostatic = 1000.0 * position @ [3.0, 1.0, -9.81]
        none = np.zeros(len(points))
        parts = NodePressures(dynamic=0.3 * hydrostatic + 55.0, kinetic=none, viscous=none)
        found.append(split_metrics(position, triangles, hydrostatic, parts))
    metrics = {name: np.array([one[name] for one in found]) for name in found[0]}
    assert bernoulli.dynamic_fraction(metrics) == pytest.approx(0.3, rel=1e-12)
    assert bernoulli.dynamic_fraction({}) is None
    still = metrics | {"dynamic_pressure_rms": np.zeros(2)}
    assert bernoulli.dynamic_fraction(still) == 0.0


def test_bernoulli_ratios_reproduce_the_thesis_figure_and_know_what_they_do_not_know() -> None:
    inch = 0.0254
    ratio = bernoulli.kinetic_ratio(
        body_force=611 * inch, radius=17.5 * inch, speed_max=0.25 * 17.5 * inch
    )
    assert ratio == pytest.approx(1118, abs=1)  # thesis Eq. 4.6, printed to 4 digits
    assert bernoulli.kinetic_ratio(body_force=1.0, radius=1.0, speed_max=None) is None
    assert bernoulli.unsteady_ratio(body_force=1.0, radius=1.0, dphi_dt_max=0.0) is None
    assert bernoulli.unsteady_ratio(body_force=10.0, radius=0.5, dphi_dt_max=2.0) == 2.5


def test_effective_gravity_is_the_largest() -> None:
    gravity = np.array([0.0, 0.0, -9.81])
    tank = np.array([[0.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    assert bernoulli.effective_gravity(gravity, tank) == pytest.approx(np.hypot(9.81, 3.0))
    assert bernoulli.effective_gravity(gravity, tank[:0]) == pytest.approx(9.81)


def test_transfer_is_the_ratio_whatever_the_direction() -> None:
    """A CG of (0.1 - 0.2i) and a force of (1.1 - 0.2i) m omega^2 times the displacement."""
    for displacement in (np.array([0.2j, 0.0, 0.0]), np.array([0.12, 0.0, 0.16]) * np.exp(0.7j)):
        excitation = tank_phasor(displacement)
        assert abs(excitation) == pytest.approx(0.2)
        response = Harmonic(
            coefficient=np.array([0.1 - 0.2j, 0.0, -0.3]) * excitation, mean=np.zeros(3), periods=1
        )
        found = transfer(response, excitation)
        assert found["real"] == pytest.approx([0.1, 0.0, -0.3])
        assert found["imag"] == pytest.approx([-0.2, 0.0, 0.0], abs=ROUNDING)
        assert found["amplitude"] == pytest.approx([np.hypot(0.1, 0.2), 0.0, 0.3])
        assert found["phase_deg"][0] == pytest.approx(-np.degrees(np.arctan2(0.2, 0.1)))
        assert found["phase_deg"][1] is None
    assert transfer(response, 0j)["real"] == [None] * 3


def test_stokes_layer_of_water() -> None:
    # Landau and Lifshitz's depth of penetration sqrt(2 nu/omega)
    assert stokes_layer(1e-6, 1.25) == pytest.approx(np.sqrt(2e-6 / (2.0 * np.pi * 1.25)))


def test_parts_of_the_pressure_are_rms_over_time_too() -> None:
    metrics = {
        "hydrostatic_pressure_rms": np.array([3.0, 4.0]),
        "dynamic_pressure_rms": np.array([1.0, 1.0]),
        "unsteady_pressure_rms": np.array([0.6, 0.8]),
    }
    split = bernoulli.pressure_split(metrics, has_flow=True)
    assert split["hydrostatic_rms_Pa"] == pytest.approx(np.sqrt(12.5))
    assert split["unsteady_fraction"] == pytest.approx(np.sqrt(0.5 / 12.5))
    assert split["kinetic_fraction"] is None
    assert bernoulli.pressure_split(metrics, has_flow=False)["unsteady_rms_Pa"] is None


def test_split_of_a_known_pressure_is_that_of_its_parts() -> None:
    points, triangles = run.disc()
    hydrostatic = 1000.0 * 9.81 * points[:, 2]
    pressures = NodePressures(
        dynamic=0.3 * hydrostatic + 7.0,
        kinetic=-0.1 * hydrostatic,
        viscous=np.full(len(points), 0.02),
    )
    found = split_metrics(points, triangles, hydrostatic, pressures)
    whole = found["hydrostatic_pressure_rms"]
    assert found["dynamic_pressure_rms"] / whole == pytest.approx(0.3, rel=1e-12)
    assert found["unsteady_pressure_rms"] / whole == pytest.approx(0.4, rel=1e-12)
    assert found["kinetic_pressure_rms"] / whole == pytest.approx(0.1, rel=1e-12)
    assert found["viscous_traction_rms"] == pytest.approx(0.02)
