"""What a run counts."""

from dataclasses import dataclass, field
from time import sleep

import known_run as run
import numpy as np
import pytest

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
