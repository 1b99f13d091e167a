"""What a run counts."""

from dataclasses import dataclass, field
from time import sleep

import known_run as run
import numpy as np
import pytest

from coupling.participants import Participants
from coupling.ports import RunFailed, StepFailed
from coupling.tally import Tally


@dataclass
class State:
    strain: np.ndarray = field(default_factory=lambda: np.array([0.2]))
    change: float = 1e-3


@dataclass
class Outcome:
    converged: bool
    iterations: int = 30
    residual: float = 0.1
    parts: tuple[()] = ()

    @property
    def sample(self) -> "Outcome":
        return self

    speed_max: float = 0.0
    dphi_dt_max: float = 0.0


def test_a_step_that_fails_on_both_sides_counts_once():
    tally = Tally(run.scene(), np.array([0.002]))
    for step in range(5):
        tally.coupling(0.02 * step, Outcome(converged=False))
        tally.structure(0.02 * step, State(), converged=False, steps=1)
        assert tally.statistics.unconverged_steps == step + 1
    tally.coupling(0.2, Outcome(converged=True))
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
    monkeypatch.setattr("coupling.participants.advance", fails)
    with pytest.raises(StepFailed):
        sides.advance(0.0, 0.02)
    assert sides.tally.statistics.wall_by_part["structure"] >= 0.02
