"""When a coupled step counts as converged."""

import numpy as np
import pytest

from coupling.step.convergence import Convergence, rms


def test_rms_is_of_lengths():
    assert rms(np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0]])) == pytest.approx(5 / np.sqrt(2))


def test_residual_is_measured_by_the_step():
    criterion = Convergence(tolerance=1e-3, acceleration=0.0)
    residual, increment = np.full((7, 3), 1e-5), np.full((7, 3), 1e-2)
    assert criterion.relative(residual, increment, 1.0) == pytest.approx(1e-3)


def test_step_at_rest_is_measured_by_the_floor():
    criterion = Convergence(tolerance=1e-3, acceleration=2e-4)
    residual = np.tile([1e-7, 0.0, 0.0], (5, 1))
    assert criterion.relative(residual, np.zeros((5, 3)), 1.0) == pytest.approx(5e-4)
    assert criterion.relative(residual, np.zeros((5, 3)), 0.5) == pytest.approx(4 * 5e-4)
    assert criterion.relative(np.zeros((5, 3)), np.zeros((5, 3)), 1.0) == 0.0


def test_far_is_less_than_half_the_orders_of_magnitude():
    criterion = Convergence(tolerance=1e-4, acceleration=0.0)
    assert criterion.is_far([1.0, 0.3, 1.1e-2])
    assert not criterion.is_far([1.0, 2.0, 0.9e-2])
    assert criterion.is_far([0.5, 0.5])  # no way made at all


def test_scaling_of_all_lengths_changes_nothing():
    generator = np.random.default_rng(0)
    residual, increment = generator.normal(size=(2, 6, 3))
    one = Convergence(tolerance=1e-3, acceleration=0.5).relative(residual, increment, 1.0)
    two = Convergence(tolerance=1e-3, acceleration=500.0).relative(
        1e3 * residual, 1e3 * increment, 1.0
    )
    assert two == pytest.approx(one, rel=1e-14)
