"""A sheet that would tear is said to, before a run and during it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from coupling.estimate.strength import burst_warning, stress_estimate
from coupling.ports import RunFailed
from coupling.scene.scene import Scene, scene_from
from coupling.simulation.tally import Tally
from coupling.step.dry import DryStep
from coupling.step.halving import Halving
from coupling.structure.diaphragm import diaphragm_of


def shaken(frequency: float, amplitude: float, **diaphragm: object) -> Scene:
    return scene_from(
        {
            "tank": {"radius": 0.4445},
            "diaphragm": {"material": "AF-E-332", "thickness": 0.001778} | diaphragm,
            "liquid": {"name": "water", "fill_fraction": 0.8},
            "motion": {"kind": "sine", "frequency": frequency, "amplitude": amplitude},
            "model": {"fluid": "hydrostatic"},
            "time": {"duration": 0.1, "step": 0.002},
            "cloth": {"resolution": 6},
        }
    )


def test_a_gentle_motion_is_carried_and_a_violent_one_is_not():
    """25 Hz at 0.25 m is 629 g: rho b R^2/(2 t) = 342 MPa by hand, strength 11.4 MPa."""
    assert burst_warning(shaken(1.25, 0.25)) is None
    violent = shaken(25.0, 0.25)
    b = np.hypot(9.81, 0.25 * (50.0 * np.pi) ** 2)
    assert stress_estimate(violent) == pytest.approx(997.0 * b * 0.4445**2 / (2.0 * 0.001778))
    said = burst_warning(violent)
    assert said is not None
    assert "would burst" in said
    assert "342 MPa" in said


def test_a_rubber_of_unknown_strength_is_not_judged():
    numbers = {"material": None, "density": 1070.0, "youngs_modulus": 8.6e6, "poisson_ratio": 0.5}
    given = {key: value for key, value in numbers.items() if value is not None}
    scene = shaken(25.0, 0.25)
    plain = scene.model_copy(update={"diaphragm": scene.diaphragm.model_copy(
        update={"strength": None, **given})})  # fmt: skip
    assert burst_warning(plain) is None


def test_the_largest_tension_is_kept():
    """In Pa over each triangle's own thickness."""
    scene = shaken(1.25, 0.25)
    cloth = diaphragm_of(scene)
    tally = Tally(scene, cloth.thickness, np.ones(len(cloth.thickness)))
    for force in (1e4, 4e4, 3e4):
        tension = np.zeros(len(cloth.triangles))
        tension[3] = force
        tally.stretched(0.01, replace(cloth.state, tension=tension))
    assert tally.statistics.tension_max == 4e4
    assert tally.statistics.stress_max == pytest.approx(4e4 / 0.001778)


def test_too_many_unconverged_steps_stop_the_run():
    scene = shaken(1.25, 0.25)
    cloth = diaphragm_of(scene)
    tally = Tally(scene, cloth.thickness, np.ones(len(cloth.thickness)))
    for step in range(scene.coupling.max_unconverged):
        tally.structure(0.002 * step, cloth.state, converged=False, steps=8)
    with pytest.raises(RunFailed, match=r"6 steps did not converge. Raise cloth.iterations"):
        tally.structure(0.1, cloth.state, converged=False, steps=8)
    assert tally.statistics.halved_steps == 6


def test_a_step_that_fails_is_halved_and_the_last_failure_is_raised(monkeypatch):
    """The parts add up to the whole step, each under the load of its own end."""
    cloth, begun, taken = diaphragm_of(shaken(1.25, 0.25)), [], []

    def solve(_, *, alone):
        assert alone
        if begun[-1][0] > 0.0026:
            raise ArithmeticError("too far")

    monkeypatch.setattr(cloth, "begin_step", lambda dt, load: begun.append((dt, load)))
    monkeypatch.setattr(cloth, "solve", solve)
    monkeypatch.setattr(cloth, "accept_step", lambda: taken.append(begun[-1]))
    assert Halving().advance(DryStep(cloth), 1.0, 0.01, lambda _, end: end) == 4
    assert taken == [(0.0025, pytest.approx(1.0 + 0.0025 * k)) for k in (1, 2, 3, 4)]
    with pytest.raises(ArithmeticError, match="too far"):
        Halving().advance(DryStep(cloth), 1.0, 0.1, lambda _, end: end)
