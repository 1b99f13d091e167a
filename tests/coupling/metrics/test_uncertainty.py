"""Error bars and fronts: the arithmetic, on numbers whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from coupling.metrics.comparison import NAMES
from coupling.metrics.pareto import pareto_front
from coupling.metrics.uncertainty import below, error_bars


@pytest.mark.parametrize(("factor", "order"), [(2.0, 2.0), (2 ** (1 / 3), 1.5), (1.5, 1.0)])
def test_an_error_that_falls_by_a_power_is_found(factor: float, order: float) -> None:
    """f = 1 + h^p: the reference at h = 0.1 errs by 0.1^p, whatever it is compared with."""
    difference = (factor * 0.1) ** order - 0.1**order
    bars = error_bars({"grid": {"cg_amplitude": difference}}, {"grid": (factor, order)})
    assert bars["cg_amplitude"] == pytest.approx(0.1**order, rel=1e-12)
    assert set(bars) == set(NAMES)
    assert bars["shape_rms"] is None


def test_grid_and_step_add_and_what_is_missing_adds_nothing() -> None:
    own = {"grid": {"shape_rms": 0.02}, "step": {"shape_rms": 0.03, "cg_amplitude": 0.03}}
    coarsening = {"grid": (2.0, 1.0), "step": (2.0, 2.0)}
    bars = error_bars(own, coarsening)
    assert bars["shape_rms"] == pytest.approx(0.02 + 0.01)
    assert bars["cg_amplitude"] == pytest.approx(0.01)
    assert error_bars({}, coarsening) == dict.fromkeys(NAMES)
    assert error_bars({"grid": {"shape_rms": 0.1}}, {"grid": (1.0, 1.0)})["shape_rms"] is None


def test_an_error_below_the_reference_s_own_is_said_to_be() -> None:
    assert below({"a": 0.015, "b": 0.5, "c": 0.0}, {"a": 0.02, "b": 0.001, "c": None}) == ["a"]
    assert below({"a": 0.0}, {}) == []


def test_the_front_of_known_points() -> None:
    points = [(1.0, 0.5), (2.0, 0.6), (3.0, 0.1), (3.0, 0.2), (9.0, 0.0), (10.0, 0.0), (1.0, 0.5)]
    assert pareto_front(points) == [0, 6, 2, 4]
    assert pareto_front([]) == []


values = st.integers(0, 6).map(float)


@given(st.lists(st.tuples(values, values), max_size=12))
def test_the_front_is_what_nothing_dominates(points: list[tuple[float, float]]) -> None:
    array = np.array(points).reshape(-1, 2)
    free = [
        index
        for index, point in enumerate(array)
        if not any((array <= point).all(axis=1) & (array < point).any(axis=1))
    ]
    assert sorted(pareto_front(points)) == free
