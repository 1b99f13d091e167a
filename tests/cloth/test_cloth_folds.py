"""Slack cloth thrown about folds onto itself and nowhere passes through."""

from __future__ import annotations

import numpy as np
import pytest
from test_cloth_step import GRAVITY, TANK, Water, build, run_under, sway_acceleration

from cloth.iteration import Iteration
from cloth.self_contact.crossing import crossing_pairs
from cloth.self_contact.planes import Planes
from cloth.settle import settle

STEP, FREQUENCY = 0.005, 2.0


def thrown(fill: float, seconds: float, *, self_contact: bool):
    """Committed states of 12 rings in a pad sway of 2 Hz and 0.25 m."""
    cloth = build(12, self_contact=self_contact)
    assert settle(cloth, Water(fill * TANK, GRAVITY)).converged

    def load(time: float) -> Water:
        push = sway_acceleration(time, FREQUENCY)
        return Water(fill * TANK, GRAVITY - np.array([push, 0.0, 0.0]))

    return cloth, list(run_under(cloth, load, round(seconds / STEP), STEP))


@pytest.mark.parametrize("fill", [0.1, 0.3])
def test_no_triangles_cross_and_lengths_and_volume_are_kept(fill):
    cloth, states = thrown(fill, 1.0, self_contact=True)
    for state in states:
        assert len(crossing_pairs(state.position, cloth.triangles)) == 0
        assert abs(state.volume / (fill * TANK) - 1.0) <= 1e-8


def test_without_contact_with_itself_the_same_motion_crosses():
    """Or the test above would show nothing."""
    cloth, states = thrown(0.3, 1.0, self_contact=False)
    assert any(len(crossing_pairs(state.position, cloth.triangles)) for state in states)


def test_a_restart_in_contact_is_bitwise():
    cloth, states = thrown(0.3, 0.8, self_contact=True)
    assert states[-1].self_slip.max() > 0.0
    saved = cloth.save()

    def load(time: float) -> Water:
        return Water(0.3 * TANK, GRAVITY - np.array([20.0 * np.sin(time), 0.0, 0.0]))

    for _ in run_under(cloth, load, 8, STEP):
        pass
    whole = cloth.save()
    other = build(12, self_contact=True)
    other.restore(saved)
    for _ in run_under(other, load, 8, STEP):
        pass
    for name, value in other.save().items():
        np.testing.assert_array_equal(value, whole[name], err_msg=name)


def test_solving_again_in_contact_repeats_and_is_continuous():
    """With parts touching, equal forces give equal bits and small ones answer in proportion."""
    cloth, _ = thrown(0.3, 0.8, self_contact=True)
    cloth.begin_step(STEP, Water(0.3 * TANK, GRAVITY - np.array([20.0, 0.0, 0.0])))
    zero = np.zeros_like(cloth.reference)
    push = 1e-5 * cloth.model.volume_and_gradient(cloth.state.position)[1] * cloth.reference[:, :1]
    first = cloth.solve(zero)
    moved = [np.linalg.norm(cloth.solve(e * push) - first) / e for e in (1.0, 0.5)]
    np.testing.assert_array_equal(cloth.solve(zero), first)
    assert moved[0] > 0.0
    assert moved[1] == pytest.approx(moved[0], rel=0.5)


def test_a_plane_that_leans_on_the_clamped_rim_and_is_kept_changes_nothing():
    """A node 4 mm inside of a fixed one, asked to stay 1 mm inside of it."""
    cloth = build(12, self_contact=True)
    rim = np.flatnonzero(cloth.fixed)[0]
    away = np.linalg.norm(cloth.reference - cloth.reference[rim], axis=1)
    node = np.argmin(np.where(cloth.fixed, np.inf, away))
    inward = -cloth.reference[rim] / np.linalg.norm(cloth.reference[rim])
    kept = Planes(
        nodes=np.array([[node, rim, rim, rim]]), weights=np.array([[1.0, -1.0, 0.0, 0.0]]),
        normal=inward[None], rest=np.array([1e-3]),
    )  # fmt: skip
    cloth.begin_step(STEP, Water(cloth.state.volume, GRAVITY))
    assert cloth._problem is not None
    runs = [
        Iteration(cloth._problem, np.zeros_like(cloth.reference), planes) for planes in (None, kept)
    ]
    for run in runs:
        for _ in range(5):
            run.advance()
    np.testing.assert_array_equal(runs[1].x, runs[0].x)
    assert (runs[0].x[node] - runs[0].x[rim]) @ inward > 1e-3
