"""The energy balance: exact where the motion is known, else closed to the time scheme's order."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cloth.energy import SheetEnergy
from cloth.flat import strip
from coupling.ports import HydrostaticLoad, RunFailed
from coupling.scene.scene import scene_from
from coupling.simulation.driver import run
from coupling.simulation.energy import EnergyBalance, Instant, Stored, layer_factor
from coupling.store.results import read_results
from coupling.verify.hanging import GRAVITY, chain_root, film_settings
from coupling.verify.mirrored import MirroredCloth
from coupling.verify.sheets import FILM, SLACK, TAUT

DOWN = np.array([0.0, 0.0, -GRAVITY])
MASS, OMEGA, RATE, SWING = 3.0, 5.0, 0.7, 0.2


def swinging(time: float, spring: float, damping: float) -> tuple[Instant, Stored]:
    """A mass on a spring and a damper, moved by a wave of OMEGA and its second harmonic.

    The tank's acceleration is what makes it do so: m (x'' + a) = -spring x - damping x'.
    """
    one, two = OMEGA * time, 2.0 * OMEGA * time
    way = SWING * (1.3 - np.cos(one) - 0.3 * np.cos(two))
    speed = SWING * OMEGA * (np.sin(one) + 0.6 * np.sin(two))
    second = SWING * OMEGA**2 * (np.cos(one) + 1.2 * np.cos(two))
    return Instant(
        acceleration=np.array([-second - (spring * way + damping * speed) / MASS, 0.0, 0.0]),
        moment=MASS * np.array([[way, 0.0, 0.0], [0.0, 0.0, 0.0]]),
        volume=1.0,
        datum=100.0,
    ), Stored(
        flow=0.5 * MASS * speed**2, sheet=SheetEnergy(kinetic=0.0, bending=0.5 * spring * way**2)
    )  # fmt: skip


def balance(steps: int, duration: float, *, damping: float = 0.0) -> dict[str, float]:
    """Of ``duration`` [s] of that motion."""
    dt, found = duration / steps, EnergyBalance(DOWN)
    found.start(*swinging(0.0, 40.0, damping))
    for k in range(1, steps + 1):
        before, _ = swinging((k - 1) * dt, 40.0, damping)
        instant, stored = swinging(k * dt, 40.0, damping)
        both = 0.5 * (before.acceleration + instant.acceleration)
        found.add(dt, replace(instant, acceleration=both), 0.0)
    return found.metrics(stored)


def test_known_motion_without_damping_closes_with_the_square_of_the_step():
    errors = np.array([balance(steps, 1.9)["dissipated"] for steps in (100, 200, 400)])
    assert abs(errors[-1]) < 1e-3 * balance(400, 1.9)["mechanical_energy"]
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx([2.0, 2.0], abs=0.02)


def test_known_damping_is_found():
    """c int x'^2 dt over three periods, to the trapezoidal rule's (2 OMEGA dt)^2/12 of the work."""
    duration = 3.0 * 2.0 * np.pi / OMEGA
    exact = RATE * (SWING * OMEGA) ** 2 * (1.0 + 0.36) / 2.0 * duration
    found = balance(400, duration, damping=RATE)
    allowed = (2.0 * OMEGA * duration / 400) ** 2 / 12.0
    assert found["dissipated"] == pytest.approx(exact, rel=2.0 * allowed)
    assert found["tank_work"] == pytest.approx(
        exact, rel=2.0 * allowed
    )  # a whole period stores none


def test_a_liquid_that_gives_all_its_energy_to_the_sheet_dissipates_nothing():
    instant, stored = swinging(0.1, 0.0, 0.0)
    found = EnergyBalance(DOWN)
    found.start(instant, stored)
    found.add(0.01, instant, stored.flow)
    metrics = found.metrics(Stored(flow=0.0, sheet=SheetEnergy(kinetic=stored.flow)))
    assert metrics["dissipated_by_liquid"] == 0.0
    assert metrics["dissipated"] == pytest.approx(0.0, abs=1e-15)


def test_lifting_costs_and_a_changing_volume_is_paid_by_the_datum():
    instant, stored = swinging(0.0, 0.0, 0.0)
    raised = replace(instant, moment=np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.5]]), volume=1.25)
    found = EnergyBalance(DOWN)
    found.start(instant, stored)
    found.add(0.01, raised, 0.0)
    metrics = found.metrics(stored)
    assert metrics["liquid_potential_energy"] == pytest.approx(2.0 * GRAVITY)
    assert metrics["sheet_potential_energy"] == pytest.approx(0.5 * GRAVITY)
    assert metrics["datum_work"] == pytest.approx(25.0)
    assert metrics["dissipated"] == pytest.approx(25.0 - 2.5 * GRAVITY)


def test_restored_balance_goes_on_bit_for_bit():
    one, other = EnergyBalance(DOWN), EnergyBalance(DOWN)
    one.start(*swinging(0.0, 40.0, RATE))
    one.add(0.01, swinging(0.01, 40.0, RATE)[0], 0.3)
    other.restore(one.save())
    instant, stored = swinging(0.02, 40.0, RATE)
    for each in (one, other):
        each.add(0.01, instant, -0.1)
    assert one.metrics(stored) == other.metrics(stored)


def test_checkpoint_of_an_older_version_is_refused_with_the_mend():
    with pytest.raises(RunFailed, match="Run the scene again"):
        EnergyBalance(DOWN).restore({})


def chain_balance(step: float, *, shaken: bool) -> dict[str, float]:
    """1.6 s of an undamped hanging chain of 1 m, its support shaken, or pushed once and let be."""
    mesh = strip(1.0, np.sqrt(3.0) / 16, 16)
    mesh = replace(mesh, fixed=mesh.points[:, 0] == 0.0)
    settings = film_settings(100.0 * GRAVITY, 400)
    cloth = MirroredCloth(
        mesh=mesh, diaphragm=replace(FILM, density=1.0), tensile_stiffness=100.0 * TAUT,
        compressive_stiffness=SLACK, settings=settings,
    )  # fmt: skip
    first = replace(settings, iterations=2000)
    omega = 0.5 * chain_root(1) * np.sqrt(GRAVITY)
    gravity, none = np.array([GRAVITY, 0.0, 0.0]), np.zeros_like(cloth.reference)

    def shaking(time: float) -> np.ndarray:
        pulse = 2.0 * np.sin(omega * time) ** 2 if shaken or omega * time < np.pi else 0.0
        return np.array([0.0, 0.0, pulse])

    def instant(time: float) -> Instant:
        losses = cloth.losses()
        return Instant(
            acceleration=0.5 * (shaking(time - step) + shaking(time)),
            moment=np.array([[0.0, 0.0, 0.0], cloth.mass @ cloth.state.position]),
            volume=1.0,
            datum=0.0,
            bending_damping=losses.bending,
            drag=losses.drag,
        )

    found = EnergyBalance(gravity)
    found.start(instant(0.0), Stored(flow=0.0, sheet=cloth.energy()))
    for k in range(round(1.6 / step)):
        time = (k + 1) * step
        load = HydrostaticLoad(density=0.0, body_force=gravity - shaking(time), datum=0.0)
        cloth.begin_step(step, load, settings=first if k == 0 else None)
        cloth.solve(none)
        cloth.accept_step()
        found.add(step, instant(time), 0.0)
    return found.metrics(Stored(flow=0.0, sheet=cloth.energy()))


@pytest.mark.parametrize("shaken", [False, True])
def test_undamped_chain_dissipates_with_the_square_of_the_step_at_least(shaken: bool):
    """BDF2 damps with the third power of the step, the balance closes with its square.

    Below 0.01 s the chain's own stretch counts, which the inner iteration leaves: some 1e-5 J.
    """
    ends = [chain_balance(step, shaken=shaken) for step in (0.04, 0.02, 0.01)]
    lost = np.array([end["dissipated"] for end in ends])
    assert ends[-1]["tank_work"] > 100.0 * lost[-1] > 0.0
    assert ends[-1]["dissipated_by_drag"] == ends[-1]["dissipated_by_bending"] == 0.0
    assert np.log2(lost[:-1] / lost[1:]).min() > 1.9


def tank(**changes: dict):
    data = {
        "tank": {"radius": 0.4445},
        "diaphragm": {
            "thickness": 0.001778, "density": 1070.0, "youngs_modulus": 8.6e6, "poisson_ratio": 0.5,
        },
        "liquid": {"density": 1000.0, "viscosity": 1e-6, "fill_fraction": 0.8},
        "motion": {"kind": "sine", "frequency": 1.25, "amplitude": 0.25},
        "cloth": {"resolution": 6},
        "time": {"settle": 0.3, "duration": 0.2, "step": 0.02, "output_every": 1},
    }  # fmt: skip
    for section, values in changes.items():
        data[section] = data.get(section, {}) | values
    return scene_from(data)


@pytest.mark.parametrize("fluid", ["hydrostatic", "potential"])
def test_a_held_diaphragm_neither_works_nor_dissipates(tmp_path, fluid: str):
    run(tank(diaphragm={"held": True}, model={"fluid": fluid}), tmp_path)
    metrics = read_results(tmp_path).metrics
    for name in ("tank_work", "mechanical_energy", "dissipated", "dissipated_by_liquid"):
        assert np.abs(metrics[name]).max() < 1e-20, name  # a still liquid's rounding, squared


def test_loss_time_is_that_of_its_frequency_or_of_the_sine_s():
    rubber = {"inextensible": False, "loss_factor": 0.15}
    assert tank(diaphragm=rubber).loss_time == pytest.approx(0.15 / (2.0 * np.pi * 1.25))
    given = tank(diaphragm=rubber | {"loss_frequency": 10.0}, motion={"kind": "rest"})
    assert given.loss_time == pytest.approx(0.15 / (2.0 * np.pi * 10.0))
    assert tank().loss_time == 0.0


def test_the_rubber_s_own_losses_are_summed_by_name(tmp_path):
    """What nothing takes is none; a part of them is not what closes the balance."""
    ends = []
    own = {"inextensible": False, "loss_factor": 0.15, "friction_shell": 0.3, "friction_self": 0.3}
    for name, rubber in (("without", {"inextensible": False}), ("with", own)):
        run(tank(diaphragm=rubber, model={"fluid": "hydrostatic"}), tmp_path / name)
        metrics = read_results(tmp_path / name).metrics
        ends.append({name: values[-1] for name, values in metrics.items()})
    without, taken = ends
    for name in ("stretch", "shell_friction", "self_friction"):
        assert without[f"dissipated_by_{name}"] == 0.0
        assert taken[f"dissipated_by_{name}"] < taken["dissipated"]
    assert taken["dissipated_by_stretch"] > 0.0
    assert taken["dissipated_by_shell_friction"] > 0.0


def test_output_every_changes_no_sum(tmp_path):
    """Every step is summed, whatever is written out."""
    ends = []
    for every in (1, 5):
        folder = tmp_path / str(every)
        run(tank(model={"fluid": "potential"}, time={"output_every": every}), folder)
        ends.append({name: values[-1] for name, values in read_results(folder).metrics.items()})
    assert ends[0] == ends[1]
    assert ends[0]["tank_work"] != 0.0
    assert ends[0]["pressure_work"] != 0.0


def test_wall_layer_s_power_is_that_of_landau_and_lifshitz():
    """Half of v0^2 sqrt(rho eta omega/2) per area, of a mean square of v0^2/2 (section 24)."""
    scene = tank()
    density, viscosity, omega = 1000.0, 1e-6, 2.0 * np.pi * 1.25
    exact = 0.5 * 0.3**2 * np.sqrt(density * density * viscosity * omega / 2.0)
    assert layer_factor(scene) * 0.3**2 / 2.0 == pytest.approx(exact)
    assert layer_factor(tank(motion={"kind": "rest"})) == 0.0
