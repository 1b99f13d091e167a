"""The policies of a coupled step, each by itself, and the loop that asks them."""

from types import SimpleNamespace

import numpy as np
import pytest

from coupling.ports import RunFailed, StepFailed
from coupling.schemes.added_mass import AddedMass
from coupling.schemes.fixed_point import FixedPoint
from coupling.step.backtracking import Backtracking, BacktrackingSettings
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledSettings, CoupledStep
from coupling.step.history import History
from coupling.step.interface_step import Iterate
from coupling.step.remap import Remap, RemapSettings

CRITERION = Convergence(tolerance=1e-4, acceleration=0.0)
GOAL = np.ones((3, 3))


def reached(limit):
    """An ask that has an answer for points up to ``limit`` only."""

    def ask(points):
        if points.max() > limit:
            raise StepFailed("too far")
        return points

    return ask


def test_backtracking_halves_the_way_until_there_is_an_answer():
    backtracking = Backtracking(BacktrackingSettings(halvings=2))
    assert (backtracking.nearest(reached(1.0), GOAL, 0.0 * GOAL) == GOAL).all()
    assert (backtracking.nearest(reached(0.3), GOAL, 0.0 * GOAL) == 0.25 * GOAL).all()
    with pytest.raises(StepFailed):
        backtracking.nearest(reached(0.2), GOAL, 0.0 * GOAL)


def history_of(*maps):
    history = History()
    for residuals in maps:
        history.begin_map()
        for residual in residuals:
            history.add(residual)
    return history


def test_history_tells_the_maps_apart():
    history = history_of([1.0, 0.5], [2.0])
    assert history.on_map == [2.0]
    assert history.residuals == [1.0, 0.5, 2.0]


def test_remap_is_due_where_iterations_diverge_or_get_nowhere():
    remap = Remap(RemapSettings(slow=2, maps=2))
    slow = [1.0, 0.9, 0.8]
    assert remap.is_due(history_of(slow), CRITERION, diverged=False)
    assert not remap.is_due(history_of(slow[:2]), CRITERION, diverged=False)  # too few to judge
    assert remap.is_due(history_of(slow[:2]), CRITERION, diverged=True)
    assert not remap.is_due(history_of([1.0, 0.1, 5e-3]), CRITERION, diverged=False)
    assert not remap.is_due(history_of(slow, slow), CRITERION, diverged=True)  # the last map


class Linear:
    """x = factor x + 1 from 0; remapped, with ``later`` for a factor."""

    moves = True

    def __init__(self, factor, later=0.0):
        self.factor, self.later = factor, later
        self.step = SimpleNamespace(start=np.zeros((3, 3)))
        self.images, self.maps, self.abandoned = 0, 1, False

    def begin_step(self, time, dt, load):
        return np.full((3, 3), 0.5)

    def remap(self):
        self.factor, self.maps = self.later, self.maps + 1
        return np.full((3, 3), 0.5)

    def abandon(self):
        self.abandoned = True

    def image(self, points):
        self.images += 1
        return Iterate(points=points, pressure=np.zeros(1), image=self.factor * points + 1.0)

    def accept_step(self):
        return SimpleNamespace(volume_error=0.0)


def coupled(problem, scheme, *, policies=True, **settings):
    """A step on ``problem``, whose structure and flow nobody asks."""
    step = CoupledStep(
        None, None, None, scheme, takes_inertia=policies, convergence=CRITERION,
        max_iterations=30, record=lambda *_: None, settings=CoupledSettings(**settings),
    )  # fmt: skip
    step.problem = problem
    return step


def test_a_step_converges_by_its_scheme():
    problem = Linear(0.5)
    step = coupled(problem, FixedPoint())
    step.attempt(0.0, 0.1, None)
    step.accept()
    # The residual over the step's displacement is 0.5/0.5 first and halves: 2^-14 < 1e-4.
    assert 12 <= step.report().iterations <= 15
    assert problem.maps == 1


def test_a_step_that_stagnates_on_its_map_gets_a_new_one():
    problem = Linear(-5.0, later=0.1)
    step = coupled(problem, FixedPoint(), diverged=5.0)
    step.attempt(0.0, 0.1, None)
    assert problem.maps == 2
    assert not problem.abandoned


def test_a_step_that_diverges_on_all_maps_fails_and_is_abandoned():
    problem = Linear(-5.0, later=-5.0)
    step = coupled(problem, FixedPoint(), diverged=5.0, remap=RemapSettings(maps=2))
    with pytest.raises(RunFailed, match="the coupling diverges"):
        step.attempt(0.0, 0.1, None)
    assert problem.maps == 2
    assert problem.abandoned


def test_a_scheme_without_the_liquids_inertia_has_no_policies():
    problem = Linear(-5.0, later=0.1)
    with pytest.raises(RunFailed, match="the coupling diverges"):
        coupled(problem, FixedPoint(), policies=False, diverged=5.0).attempt(0.0, 0.1, None)
    assert problem.maps == 1


def test_a_secant_solves_a_linear_step_without_policies():
    problem = Linear(-5.0)
    coupled(problem, AddedMass(), policies=False).attempt(0.0, 0.1, None)
    assert problem.images == 3  # two residuals make a secant


def test_an_attempt_that_is_not_accepted_leaves_no_trace():
    """A second one begins where the first did: on its map, and with the scheme's memory of then."""

    class Counting(FixedPoint):
        updates = 0

        def update(self, points, residual):
            self.updates += 1
            return super().update(points, residual)

        def save(self):
            return {"updates": np.array(self.updates)}

        def restore(self, saved):
            self.updates = int(saved["updates"])

    problem, scheme = Linear(0.5), Counting()
    step = coupled(problem, scheme)
    step.attempt(0.0, 0.1, None)
    once = scheme.updates
    assert once > 5
    assert not problem.abandoned
    step.attempt(0.0, 0.05, None)
    assert problem.abandoned
    assert scheme.updates == once
    problem.abandoned = False
    step.accept()
    step.attempt(0.1, 0.1, None)
    assert not problem.abandoned
    assert scheme.updates == 2 * once
