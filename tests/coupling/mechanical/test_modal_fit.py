"""The fit finds a known model again within its stated error, and a free surface's first mode."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.signal import lsim

from coupling.estimate.sloshing_modes import lateral_eigenvalue, surface_inertia
from coupling.mechanical.apparent_mass import Band, apparent_mass
from coupling.mechanical.excitation import HIGH, LOW, STEPS_A_PERIOD, random_record, sweep
from coupling.mechanical.modal_choice import choose
from coupling.mechanical.modal_model import ModalModel, unit_force
from coupling.mechanical.recording import Recording
from coupling.mechanical.validation import force_error
from coupling.ports import HydrostaticLoad
from coupling.verify.level_tank import level_tank
from coupling.verify.potential_slosh import level_liquid

SLOSH = 0.95  # Hz
STEP = 1.0 / (STEPS_A_PERIOD * SLOSH)
BAND = Band(low=0.5 * LOW * SLOSH, high=HIGH * SLOSH)
TRUE = ModalModel(
    total=180.0,
    masses=np.array([95.0, 8.0]),
    omegas=2.0 * np.pi * np.array([0.96, 1.9]),
    dampings=np.array([0.006, 0.03]),
    heights=np.array([-0.02, 0.05, -0.1]),
)


def recorded(name, acceleration, model=TRUE, noise=0.0, seed=0):
    """What ``model`` would show, with white noise of that share of the largest force."""
    forces = model.forces(acceleration, STEP)
    force, moment = forces.sum(axis=0), model.heights @ forces
    generator = np.random.default_rng(seed)
    size = noise * np.abs(force).max()
    return Recording(
        name=name,
        step=STEP,
        acceleration=acceleration,
        force=force + size * generator.normal(size=len(force)),
        moment=moment + 0.1 * size * generator.normal(size=len(force)),
    )


def sweeps(noise, seed):
    return [
        recorded(name, sweep(0.002, SLOSH, STEP, upwards=up), noise=noise, seed=seed + up)
        for name, up in (("up", True), ("down", False))
    ]


def test_a_mode_in_time_is_that_of_its_differential_equation():
    """Against ``scipy.signal.lsim``, which is exact for the same linear course between instants."""
    omega, damping = 5.0, 0.03
    acceleration = np.random.default_rng(1).normal(size=200)
    system = (
        [[0.0, 1.0], [-(omega**2), -2.0 * damping * omega]],
        [[0.0], [-1.0]],
        [[omega**2, 2.0 * damping * omega]],
        [[0.0]],
    )
    exact = lsim(system, acceleration, 0.01 * np.arange(200))[1]
    assert unit_force(omega, damping, acceleration, 0.01) == pytest.approx(exact, abs=1e-12)


def test_the_apparent_mass_is_that_of_a_steady_sine():
    """After 40 periods of a wave that falls by e in 1.3 of them, to the error of linear courses."""
    model = ModalModel(
        total=3.0, masses=np.array([2.0]), omegas=np.array([5.0]), dampings=np.array([0.12]),
        heights=np.zeros(2),
    )  # fmt: skip
    omega, step = 4.0, 2.0 * np.pi / 4.0 / 400
    time = step * np.arange(40 * 400 + 1)
    acceleration = np.sin(omega * time)
    force = model.forces(acceleration, step).sum(axis=0)
    wave = np.exp(-1j * omega * time[-400:])
    found = -(force[-400:] @ wave) / (acceleration[-400:] @ wave)
    assert abs(found / model.apparent_mass(np.array([omega]))[0] - 1.0) < 1e-4  # (w step)^2/12


def test_at_rest_and_slowly_the_liquid_is_one_body():
    assert TRUE.apparent_mass(np.array([0.0]))[0] == pytest.approx(TRUE.total)


@pytest.mark.parametrize("seed", [0, 10, 20])
def test_two_modes_with_noise_are_found_within_what_is_stated(seed):
    """Each of nine figures within three standard errors, which one in 40 such sets would miss."""
    choice = choose(sweeps(0.02, seed), TRUE.total, BAND)
    fit = choice.fit
    assert fit.modes == 2
    found = np.concatenate([fit.model.masses, fit.model.omegas, fit.model.dampings])
    true = np.concatenate([TRUE.masses, TRUE.omegas, TRUE.dampings])
    error = np.sqrt(np.diag(fit.covariance))
    assert (np.abs(found - true) < 3.0 * error).all()
    assert (np.abs(fit.model.heights - TRUE.heights) < 3.0 * fit.heights_error).all()
    assert (error < 0.05 * np.abs(true)).all()  # and what is stated is not everything


def test_without_noise_the_model_comes_back_and_is_followed():
    fit = choose(sweeps(0.0, 0), TRUE.total, BAND).fit
    assert fit.model.masses == pytest.approx(TRUE.masses, rel=1e-4)
    assert fit.model.heights == pytest.approx(TRUE.heights, abs=1e-6)
    unseen = recorded("record", random_record(0.002, SLOSH, STEP))
    assert force_error(unseen, fit.model) < 1e-4


def test_one_mode_is_taken_where_there_is_one():
    alone = ModalModel(
        total=180.0, masses=TRUE.masses[:1], omegas=TRUE.omegas[:1], dampings=TRUE.dampings[:1],
        heights=np.zeros(2),
    )  # fmt: skip
    runs = [
        recorded(str(up), sweep(0.002, SLOSH, STEP, upwards=up), alone, noise=0.02, seed=up)
        for up in (False, True)
    ]
    choice = choose(runs, alone.total, BAND)
    assert choice.fit.modes == 1
    assert set(choice.left_out) == {1, 2, 3}


def test_runs_that_contradict_each_other_lower_the_coherence():
    same, other = sweeps(0.0, 0)
    softer = ModalModel(**{**vars(TRUE), "omegas": 0.97 * TRUE.omegas})
    moved = recorded("down", other.acceleration, softer)
    agreeing = apparent_mass([same, other], TRUE, BAND).coherence
    assert agreeing.min() > 1.0 - 1e-9
    assert apparent_mass([same, moved], TRUE, BAND).coherence.min() < 0.9


def test_a_sweep_starts_and_ends_at_rest_and_keeps_its_amplitude():
    acceleration = sweep(0.002, SLOSH, STEP, upwards=True)
    speed = np.cumsum(acceleration) * STEP
    assert acceleration[0] == 0.0
    assert acceleration[-1] == pytest.approx(0.0, abs=1e-6)
    assert abs(speed[-1]) < 1e-3 * np.abs(speed).max()
    place = np.cumsum(speed) * STEP
    assert np.abs(place).max() == pytest.approx(0.002, rel=0.05)  # sums of first order in the step


def free_surface(upwards):
    """A sweep of a half full sphere without a sheet, by the verification's own free surface."""
    slosh = np.sqrt(lateral_eigenvalue(1.0, 1) * 9.81 / 0.4445) / (2.0 * np.pi)
    step = 1.0 / (STEPS_A_PERIOD * slosh)
    total = 2.0 / 3.0 * np.pi * 0.4445**3 * 1000.0
    surface, rows = level_liquid(level_tank("sphere"), 0.0, 6)
    acceleration = sweep(0.002, slosh, step, upwards=upwards)
    moved = [0.0]  # kg m of what the liquid's volume shifts within the tank
    for value in acceleration[1:]:
        body_force = np.array([-value, 0.0, -9.81])
        load = HydrostaticLoad(density=1000.0, body_force=body_force)
        surface.begin_step(step, load, rows)
        surface.solve(np.zeros_like(surface.reference))
        surface.accept_step()
        moved.append(1000.0 * surface.moment(surface.reference[:, 0]))
    force = -total * acceleration - np.gradient(np.gradient(moved, step), step)
    recording = Recording(
        name=str(upwards), step=step, acceleration=acceleration, force=force,
        moment=np.zeros_like(force),
    )  # fmt: skip
    return recording, total, slosh


def first_share():
    """Mass of the first mode over the liquid's, by ``sloshing_modes`` alone.

    Heights h_k of unit kinetic energy have the coupling g_k = int x h_k dA with a sideways
    acceleration, and the mass rho g_k^2 of a mode.
    """
    node, weight = np.polynomial.legendre.leggauss(60)
    node, weight = 0.5 * (node + 1.0), 0.5 * weight
    heights = np.stack(
        [node * np.polynomial.Legendre.basis(k)(2.0 * node - 1.0) for k in range(12)]
    )
    inertia = surface_inertia(1.0, node, weight, heights)
    stiffness = (heights * weight * node) @ heights.T
    coupling = heights @ (weight * node**2)
    values, shapes = eigh(stiffness, inertia)
    return values[0], (shapes[:, 0] @ coupling) ** 2 / (2.0 / 3.0)


def test_a_free_surface_has_the_textbook_first_mode():
    """Half full: lambda = 1.5602, and the mass share of an independent method, to 2 %.

    The steps lower lambda by 2/3 (w step)^2, 0.3 %, the surface's grid by 0.6 %.
    """
    (up, total, slosh), (down, _, _) = free_surface(True), free_surface(False)
    band = Band(low=0.5 * LOW * slosh, high=HIGH * slosh)
    model = choose([up, down], total, band).fit.model
    eigenvalue, share = first_share()
    assert eigenvalue == pytest.approx(1.5602, abs=1e-4)
    assert model.omegas[0] ** 2 * 0.4445 / 9.81 == pytest.approx(1.5602, rel=0.02)
    assert model.masses[0] / total == pytest.approx(share, rel=0.02)
