"""When an inner iteration counts as stalled: what no longer gains has no end to wait for."""

from types import SimpleNamespace

import pytest

from cloth.iteration import PATIENCE, Iteration


def stalled(moves: list[float], tolerance: float = 1e-5) -> bool:
    run = SimpleNamespace(
        problem=SimpleNamespace(settings=SimpleNamespace(tolerance=tolerance)),
        done=len(moves),
        moves=moves,
    )
    return Iteration.stalled.fget(run)


@pytest.mark.parametrize("rate", [0.5, 0.98])
def test_what_contracts_is_not_stalled(rate: float):
    """0.98 is the slowest contraction that the estimate of what is left admits."""
    assert not stalled([rate**k for k in range(1000)])


def test_what_goes_round_is_stalled():
    cycle = [1.0, 2.0, 1.5]
    falling = [0.9**k for k in range(PATIENCE)]
    assert stalled([*falling, *(cycle * PATIENCE)])


def test_a_fixed_number_of_iterations_is_never_stalled():
    assert not stalled([1.0] + [2.0] * 10 * PATIENCE, tolerance=0.0)
