"""A patch that slides without friction under its own weight: pressure and slip work are known."""

from __future__ import annotations

import numpy as np
import pytest

from tests.cloth.test_cloth_friction import (
    GRAVITY,
    SHEET,
    STEP,
    advance,
    patch,
    pulled,
    stacked,
)

SPEED, STEPS = 0.3, 10
PRESSURE = SHEET.density * SHEET.thickness * GRAVITY  # [Pa], of the patch's own weight
WAY = SPEED * STEP * STEPS  # [m]


def thrown(cloth, steps: int) -> None:
    """Slide the free nodes along x at ``SPEED``, after a step at rest in which contact sets in."""
    advance(cloth, pulled(0.0), 1)
    cloth.halt()
    throw = np.where(cloth.fixed[:, None], 0.0, [[SPEED, 0.0, 0.0]])
    cloth.restore({**cloth.save(), "velocity": throw})
    advance(cloth, pulled(0.0), steps)


def test_a_patch_dragged_over_the_wall_does_the_work_of_its_weight():
    """p is rho t g at every node, as mass and area are lumped alike; the wall bends by 1e-5."""
    cloth = patch(0.0)
    thrown(cloth, STEPS)
    state = cloth.state
    assert state.shell_pressure == pytest.approx(np.full(len(cloth.mass), PRESSURE), rel=1e-3)
    assert state.shell_slip == pytest.approx(np.full(len(cloth.mass), WAY), rel=1e-3)
    assert state.shell_work == pytest.approx(np.full(len(cloth.mass), PRESSURE * WAY), rel=1e-2)
    assert not state.self_pressure.any()
    assert not state.self_work.any()
    middle = state.position - [0.5 * WAY, 0.0, 0.0]  # of the way, under an even pressure
    np.testing.assert_allclose(state.rub_place, middle, atol=1e-3 * WAY)


def test_a_sheet_dragged_over_another_does_the_same_work_on_both():
    """Pairs share the weight unevenly among the nodes, but not in all."""
    cloth = stacked(0.0)
    thrown(cloth, STEPS)
    state, area, upper = cloth.state, cloth.model.node_areas, ~cloth.fixed
    weight = GRAVITY * float(cloth.mass[upper].sum())
    for side in (upper, ~upper):
        assert area[side] @ state.self_pressure[side] == pytest.approx(weight, rel=1e-2)
        assert area[side] @ state.self_work[side] == pytest.approx(weight * WAY, rel=1e-2)
    assert not state.shell_work.any()


def test_a_half_of_the_steps_and_a_restart_give_the_same_bits():
    whole, part = patch(0.0), patch(0.0)
    thrown(whole, STEPS)
    thrown(part, STEPS // 2)
    other = patch(0.0)
    other.restore(part.save())
    advance(other, pulled(0.0), STEPS - STEPS // 2)
    for name, value in whole.save().items():
        np.testing.assert_array_equal(other.save()[name], value)
