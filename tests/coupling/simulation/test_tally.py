"""What a run counts."""

import json
from dataclasses import dataclass, field
from pathlib import Path
from time import sleep

import known_run as run
import numpy as np
import pytest

import coupling
from coupling.metrics.strains import quantile
from coupling.ports import RunFailed, StepFailed, StepReport
from coupling.simulation.participants import Participants
from coupling.simulation.tally import Tally


@dataclass
class State:
    strain: np.ndarray = field(default_factory=lambda: np.array([0.2]))
    change: float = 1e-3


@dataclass
class Strained:
    strain: np.ndarray
    tension: np.ndarray


def outcome(*, converged: bool) -> StepReport:
    return StepReport(iterations=30, residual=0.1, converged=converged, samples=())


def test_a_step_that_fails_on_both_sides_counts_once():
    tally = Tally(run.scene(), np.array([0.002]), np.ones(1))
    for step in range(5):
        tally.coupling(0.02 * step, outcome(converged=False), volume=1.0, supplied=1.0)
        tally.structure(0.02 * step, State(), converged=False, steps=1)
        assert tally.statistics.unconverged_steps == step + 1
    tally.coupling(0.2, outcome(converged=True), volume=1.0, supplied=1.0)
    with pytest.raises(RunFailed, match="6 steps did not converge"):  # five are allowed
        tally.structure(0.2, State(), converged=False, steps=1)


def of_steps(number, **settings):
    """The scene with so many steps, and these settings of the coupling."""
    scene = run.scene()
    time = scene.time.model_copy(update={"duration": number * scene.time.step})
    coupling = scene.coupling.model_copy(update=settings)
    return scene.model_copy(update={"time": time, "coupling": coupling})


@pytest.mark.parametrize(
    ("steps", "allowed", "settings"),
    [
        (1, 0, {}),  # a fifth of them
        (4, 0, {}),
        (5, 1, {}),
        (10, 2, {}),
        (24, 4, {}),
        (25, 5, {}),  # from here on the number
        (160, 5, {}),
        (10, 3, {"max_unconverged_share": 0.3}),  # 0.3 * 10 is below 3 in floating point
        (10, 10, {"max_unconverged_share": 1.0, "max_unconverged": 10}),
        (10, 0, {"max_unconverged_share": 0.0}),
    ],
)
def test_a_short_run_may_not_leave_most_of_its_steps_unconverged(steps, allowed, settings):
    """Five were allowed however few there were: a run of five in which none converged completed."""
    tally = Tally(of_steps(steps, **settings), np.array([0.002]), np.ones(1))
    for step in range(allowed):
        tally.structure(0.02 * step, State(), converged=False, steps=1)
    if allowed == steps:
        return
    with pytest.raises(RunFailed, match=f"{allowed + 1} (of {steps} )?steps did not converge"):
        tally.structure(1.0, State(), converged=False, steps=1)


def test_the_message_names_the_share_and_the_mend():
    tally = Tally(of_steps(3), np.array([0.002]), np.ones(1))
    wanted = (
        r"1 of 3 steps did not converge, and no more than 0\.2 of them may "
        r"\(coupling\.max_unconverged_share\)\. Raise cloth\.iterations"
    )
    with pytest.raises(RunFailed, match=wanted):
        tally.structure(0.02, State(), converged=False, steps=1)


def test_the_time_of_a_step_that_fails_is_not_the_rest(monkeypatch, tmp_path):
    """A run that ended in its first step said: the rest, 100 %."""

    def fails(*_, **__):
        sleep(0.02)
        raise StepFailed("t = 0.02 s: of the test")

    scene = run.scene()
    model = scene.model.model_copy(update={"fluid": "hydrostatic"})
    sides = Participants(scene.model_copy(update={"model": model}), tmp_path)
    monkeypatch.setattr(sides.cloth, "solve", fails)
    with pytest.raises(StepFailed):
        sides.advance(0.0, 0.02)
    assert sides.tally.statistics.wall_by_part["structure"] >= 0.02


def test_the_strain_that_99_percent_of_area_and_time_stay_below():
    """Of 1 + 1 s, a triangle of area 3 is strained by 0.2 % for 1 s, the rest is slack."""
    tally = Tally(run.scene(), np.full(2, 0.002), np.array([3.0, 1.0]))
    for strain in (np.array([-0.1, 0.0]), np.array([0.002, -0.3])):
        state = Strained(strain=strain, tension=np.zeros(2))
        for _ in range(10):
            tally.stretched(0.1, state)
    areas = tally.statistics.strain_areas
    assert sum(areas) == pytest.approx(8.0)
    assert quantile(areas, 0.99) == pytest.approx(0.002, rel=0.05)
    assert quantile(areas, 5.0 / 8.0 - 1e-9) == 0.0
    assert quantile([], 0.99) == 0.0


def test_inner_iterations_are_counted_by_solve():
    tally = Tally(run.scene(), np.full(1, 0.002), np.ones(1))
    for iterations, converged in ((10, True), (40, False)):
        tally.solved(iterations, converged=converged)
    counted = tally.statistics
    assert (counted.cloth_solves, counted.cloth_iterations_total) == (2, 50)
    assert (counted.cloth_iterations_max, counted.cloth_unconverged) == (40, 1)


def test_a_run_of_two_steps_that_cannot_converge_fails(tmp_path):
    """It completed, since five steps were allowed; what was computed is kept."""
    scene = Path(__file__).parents[3] / "foam_cases" / "pad_sway_coarse"
    changes = {
        "model.fluid": "hydrostatic", "cloth.resolution": 6, "time.duration": 0.02,
        "cloth.iterations": 20, "cloth.tolerance": 1e-7,
    }  # fmt: skip
    with pytest.raises(coupling.FailedRun, match="1 of 2 steps did not converge"):
        coupling.run(scene, tmp_path, changes=changes)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert (summary["status"], summary["coupling"]["unconverged_steps"]) == ("failed", 1)
