"""Exports are read back, and run, by the programs that they are for or by readers of their own."""

import json
from pathlib import Path

import numpy as np
import pytest
from fmpy import read_model_description, simulate_fmu
from pyNastran.bdf.bdf import BDF

from coupling.mechanical.exports.written import write_exports
from coupling.mechanical.modal_model import ModalModel

GRAVITY = 9.81
MODES = [
    {
        "mass_kg": 95.0, "frequency_hz": 0.96, "damping_ratio": 0.006, "pendulum_length_m": 0.2696,
        "hinge_height_m": 0.05, "spring_rate_n_m": 3456.0, "damper_n_s_m": 6.877,
        "mass_height_m": -0.2196,
    },
    {
        "mass_kg": 8.0, "frequency_hz": 1.9, "damping_ratio": 0.03, "pendulum_length_m": 0.06883,
        "hinge_height_m": -0.1, "spring_rate_n_m": 1140.1, "damper_n_s_m": 5.73,
        "mass_height_m": -0.16883,
    },
]  # fmt: skip
ROW = {
    "condition": "fill_0.5__amplitude_0.002", "failure": None, "fill_fraction": 0.5,
    "amplitude_m": 0.002, "liquid_mass_kg": 180.0, "fixed_mass_kg": 77.0, "fixed_height_m": -0.02,
    "modes": MODES,
}  # fmt: skip
CONTENT = {
    "gravity_m_s2": [0.0, 0.0, -GRAVITY], "direction": [0.0, 1.0, 0.0], "radius_m": 0.4445,
    "rows": [ROW, {"condition": "failed", "failure": "sweep_up: why"}],
}  # fmt: skip


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("exports")
    write_exports(folder, CONTENT)
    assert [path.name for path in (folder / "exports").iterdir()] == [ROW["condition"]]
    return folder / "exports" / ROW["condition"]


def test_pynastran_reads_masses_springs_and_dampers_back(place: Path):
    deck = BDF(debug=False)
    deck.read_bdf(place / "nastran.bdf", punch=True)
    masses = {number: mass.mass for number, mass in deck.masses.items()}
    assert masses == {1: 77.0, 11: 95.0, 21: 8.0}
    assert sum(masses.values()) == ROW["liquid_mass_kg"]
    for index, mode in enumerate(MODES, start=1):
        springs = [deck.elements[100 * index + 10 * axis] for axis in (1, 2)]
        dampers = [deck.elements[100 * index + 10 * axis + 1] for axis in (1, 2)]
        assert [spring.type for spring in springs] == ["CELAS2"] * 2
        assert [damper.type for damper in dampers] == ["CDAMP2"] * 2
        assert [spring.k for spring in springs] == pytest.approx([mode["spring_rate_n_m"]] * 2)
        assert [damper.b for damper in dampers] == pytest.approx([mode["damper_n_s_m"]] * 2)
        assert [spring.c1 for spring in springs] == [1, 2]


def test_the_decks_axes_are_those_of_the_motion(place: Path):
    deck = BDF(debug=False)
    deck.read_bdf(place / "nastran.bdf", punch=True)
    axes = deck.coords[1].beta()
    assert axes == pytest.approx(np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]))
    heights = {number: grid.get_position()[2] for number, grid in deck.nodes.items()}
    assert heights == pytest.approx({1: 0.0, 2: -0.02, 10: 0.05, 11: 0.05, 20: -0.1, 21: -0.1})


def test_the_fmu_moves_as_the_model(place: Path):
    """Held over a step of 1 ms the input is late by half a step, at 1 Hz 0.3 % of the force."""
    model = ModalModel(
        total=180.0, masses=np.array([95.0, 8.0]), omegas=2.0 * np.pi * np.array([0.96, 1.9]),
        dampings=np.array([0.006, 0.03]), heights=np.array([-0.02, 0.05, -0.1]),
    )  # fmt: skip
    step, count = 1e-3, 4000
    time = step * np.arange(count + 1)
    acceleration = np.sin(2.0 * np.pi * 1.1 * time) * np.minimum(time, 1.0)
    given = np.array(
        list(zip(time, acceleration, strict=True)),
        dtype=[("time", float), ("acceleration", float)],
    )
    file = str(place / "MechanicalModel.fmu")
    assert read_model_description(file).fmiVersion == "3.0"
    found = simulate_fmu(
        file, stop_time=time[-1], output_interval=step, input=given, output=["force", "moment"]
    )
    forces = model.forces(acceleration, step)
    for name, exact in (("force", forces.sum(axis=0)), ("moment", model.heights @ forces)):
        miss = found[name] - np.interp(found["time"] - 0.5 * step, time, exact)
        assert np.sqrt(np.mean(miss**2)) < 0.01 * np.sqrt(np.mean(exact**2))


def test_basilisks_particles_have_force_and_moment_of_the_pendulums(place: Path):
    """A particle moved by q under its weight has the moment (z + m g/k) k q: of the hinge."""
    told = json.loads((place / "basilisk.json").read_text(encoding="utf-8"))
    tank = told["FuelTankModelConstantVolume"]
    assert tank["propMassInit"] == 77.0
    assert tank["r_TcT_TInit"] == [[0.0], [0.0], [-0.02]]
    for particle, mode in zip(told["LinearSpringMassDamper"], MODES, strict=True):
        assert particle["pHat_B"] == [[0.0], [1.0], [0.0]]
        hinge = particle["r_PB_B"][2][0] + particle["massInit"] * GRAVITY / particle["k"]
        assert hinge == pytest.approx(mode["hinge_height_m"], abs=1e-3)
        assert (particle["k"], particle["c"]) == (mode["spring_rate_n_m"], mode["damper_n_s_m"])
