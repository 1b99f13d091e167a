"""A tank that moves as it is pushed: exact limits, momentum, energy, and going on bit for bit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coupling.report.carrier_section import carrier_section
from coupling.report.files import read_run
from coupling.scene.scene import Scene, scene_from
from coupling.simulation.driver import resume, run
from coupling.store.results import Results, read_results
from coupling.structure.diaphragm import diaphragm_of

RADIUS, WATER, FILL = 0.4445, 1000.0, 0.6
LIQUID = FILL * WATER * 4.0 / 3.0 * np.pi * RADIUS**3  # [kg]
LIGHT = 0.1 * LIQUID
PUSH, PUSHED = (60.0, 30.0, 0.0), 0.1  # N at the most, s


def free(**changes: dict) -> Scene:
    data = {
        "tank": {"radius": RADIUS},
        "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
        "liquid": {"name": "water", "density": WATER, "fill_fraction": FILL},
        "carrier": {"kind": "free", "mass": LIGHT},
        "cloth": {"resolution": 6},
        "potential": {"degree": 4},
        "time": {"duration": 0.5, "step": 0.01, "output_every": 1},
    }  # fmt: skip
    for section, values in changes.items():
        data[section] = data.get(section, {}) | values if isinstance(values, dict) else values
    return scene_from(data)


@pytest.fixture(scope="module")
def forces(tmp_path_factory) -> str:
    """A short push, then none."""
    time = np.linspace(0.0, 2.0, 401)
    size = np.where(time < PUSHED, np.sin(np.pi * time / PUSHED) ** 2, 0.0)
    file = tmp_path_factory.mktemp("forces") / "push.csv"
    head = "time (s),fx (N),fy (N),fz (N)"
    np.savetxt(file, np.c_[time, np.outer(size, PUSH)], delimiter=",", header=head, comments="")
    return str(file)


@pytest.fixture(scope="module", params=["potential", "hydrostatic"])
def pushed(request, forces, tmp_path_factory) -> tuple[Scene, Path, dict]:
    """Nothing but the push holds a tank of a tenth of its liquid's mass."""
    folder = tmp_path_factory.mktemp("pushed") / request.param
    scene = free(carrier={"force_file": forces}, model={"fluid": request.param})
    return scene, folder, run(scene, folder)


def first_moments(scene: Scene, results: Results) -> np.ndarray:
    """Of tank and contents (T, 3) [kg m] on the ground, from what was written out."""
    sheet = diaphragm_of(scene).mass
    whole = (scene.carrier.mass + sheet.sum() + LIQUID) * results.tank_displacement
    whole = whole + np.einsum("n,tnx->tx", sheet, results.position)
    if scene.model.fluid == "hydrostatic":  # whose liquid rests in the tank as far as it knows
        return whole
    return whole + WATER * results.volume[:, None] * results.liquid_cg


def test_momentum_is_kept_once_nothing_pushes(pushed):
    """To rounding, of a tank that is light; the time scheme forgets the push by 1/3 a step."""
    scene, folder, summary = pushed
    assert summary["status"] == "completed"
    results = read_results(folder)
    impulse = 0.5 * PUSHED * np.array(PUSH)
    momentum = np.diff(first_moments(scene, results), axis=0) / scene.time.step
    late = results.time[1:] > PUSHED + 26 * scene.time.step  # 3^-25 is 1e-12
    assert late.sum() > 5
    assert np.abs(momentum[late] - impulse).max() < 1e-10 * impulse[0]
    assert summary["carrier"]["momentum_kg_m_s"] == pytest.approx(impulse, abs=1e-9)


def test_light_tank_and_liquid_do_not_drive_each_other(pushed):
    """What was pushed is no faster than if the tank were empty, and the steps were whole ones."""
    scene, folder, summary = pushed
    speed = np.abs(np.gradient(read_results(folder).tank_displacement[:, 0], scene.time.step))
    assert speed.max() < 0.5 * PUSHED * PUSH[0] / LIGHT
    assert summary["halved_steps"] == 0
    assert summary["cloth"]["unconverged_steps"] == 0


def test_energy_of_the_tank_is_accounted_for(pushed):
    """The push's work is what is stored or given to the contents, but for the step's own loss."""
    scene, folder, summary = pushed
    found = summary["carrier"]
    assert abs(found["rest_J"]) < 0.02 * found["work_J"]
    assert found["damper_loss_J"] == found["spring_energy_J"] == 0.0
    if scene.model.fluid == "potential":  # all that the tank's frame gives comes from the tank
        work = read_results(folder).steps.metrics["tank_work"][-1]
        assert found["contents_work_J"] == pytest.approx(work, rel=1e-9)


def test_report_shows_how_it_moved(pushed):
    _, folder, _ = pushed
    section = carrier_section(read_run(folder))
    assert section is not None
    rows = {row[0]: row[1:] for table in section.tables for row in table.rows}
    assert rows["Taken by the dampers"] == ["0\u202fJ"]
    assert rows["Momentum with the contents at the end (kg m/s)"][:2] == ["3", "1.5"]


SPRINGS, DAMPERS, SWAY, SHAKING = (9000.0, 5000.0, 20000.0), (300.0, 0.0, 500.0), 0.02, 1.1


def rigid_body(mass: float, step: float, steps: int, axis: int) -> np.ndarray:
    """Displacement of a rigid ``mass`` on the spring and damper of an axis, by fine steps."""
    from scipy.integrate import solve_ivp

    spring, damper, omega = SPRINGS[axis], DAMPERS[axis], 2.0 * np.pi * SHAKING
    way = SWAY / np.sqrt(3.0)

    def rate(time: float, state: np.ndarray) -> list[float]:
        stretch = state[0] - way * np.sin(omega * time)
        slip = state[1] - way * omega * np.cos(omega * time)
        return [state[1], -(spring * stretch + damper * slip) / mass]

    ends = step * np.arange(steps + 1)
    found = solve_ivp(rate, (0.0, ends[-1]), [0.0, 0.0], t_eval=ends, rtol=1e-10, atol=1e-13)
    return found.y[0]


def test_filled_and_held_it_is_a_rigid_body_of_the_summed_mass(tmp_path):
    """On springs and dampers along three axes, with the square of the step."""
    errors = []
    for steps in (50, 100):
        scene = free(
            model={"fluid": "potential"}, diaphragm={"held": True}, liquid={"fill_fraction": 0.95},
            carrier={"mass": 40.0, "springs": list(SPRINGS), "dampers": list(DAMPERS)},
            motion={
                "kind": "sine", "frequency": SHAKING, "amplitude": SWAY, "ramp": 0.0,
                "direction": [1.0, 1.0, 1.0],
            },
            time={"duration": 1.0, "step": 1.0 / steps},
        )  # fmt: skip
        run(scene, tmp_path / str(steps))
        found = read_results(tmp_path / str(steps)).tank_displacement
        mass = 40.0 + scene.liquid_volume * WATER + diaphragm_of(scene).mass.sum()
        exact = np.stack([rigid_body(mass, 1.0 / steps, steps, axis) for axis in range(3)], axis=1)
        errors.append(np.abs(found - exact).max(axis=0) / np.abs(exact).max(axis=0))
    assert errors[1].max() < 0.01
    assert np.log2(errors[0] / errors[1]) == pytest.approx([2.0] * 3, abs=0.25)


def test_interrupted_it_goes_on_bit_for_bit(forces, tmp_path):
    changes = {
        "carrier": {"force_file": forces, "springs": [8000.0, 0.0, 0.0]},
        "model": {"fluid": "potential"},
    }
    ends = {"whole": 0.16, "first": 0.08}
    for name, duration in ends.items():
        run(free(**changes, time={"duration": duration}), tmp_path / name)
    resume(tmp_path / "first", scene=free(**changes, time={"duration": ends["whole"]}))
    one, other = (read_results(tmp_path / name) for name in ends)
    assert np.array_equal(one.tank_displacement, other.tank_displacement)
    assert np.array_equal(one.position, other.position)
    for name, values in one.steps.metrics.items():
        assert np.array_equal(values, other.steps.metrics[name], equal_nan=True), name
    assert np.abs(one.tank_displacement[:, 0]).max() > 1e-5


def test_a_prescribed_tank_has_no_such_figures(tmp_path):
    scene = free(
        carrier={"kind": "prescribed", "mass": None}, time={"duration": 0.02},
        model={"fluid": "hydrostatic"},
    )  # fmt: skip
    assert run(scene, tmp_path)["carrier"] is None
    assert "momentum_x" not in read_results(tmp_path).metrics
