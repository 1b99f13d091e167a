"""Error bars from three grids."""

import math

import pytest

from coupling.metrics.uncertainty import (
    error_bars,
    grid_convergence,
    observed_orders,
    shares,
)

WIDTHS = 1.31, 1.9


@pytest.mark.parametrize("order", [0.8, 1.2, 1.5])
def test_an_error_of_a_power_is_found_with_its_power(order):
    near, far = (0.01 * (width**order - 1.0) for width in WIDTHS)
    observed, error = grid_convergence(near, far, WIDTHS, 1.5)
    assert observed == pytest.approx(order)
    assert error == pytest.approx(1.25 * 0.01)


@pytest.mark.parametrize("order", [2.2, 3.5, 0.3])
def test_grids_outside_the_asymptotic_range_never_say_less_than_the_error(order):
    near, far = (0.01 * (width**order - 1.0) for width in WIDTHS)
    observed, error = grid_convergence(near, far, WIDTHS, 1.5)
    assert observed == pytest.approx(order)
    assert error > 0.0085  # of an order below a fifth of the expected one no grid tells


def test_differences_without_an_order_take_the_expected_one_three_times():
    observed, error = grid_convergence(0.02, 0.01, WIDTHS, 1.5)
    assert math.isnan(observed)
    assert error == pytest.approx(3.0 * 0.02 / (WIDTHS[0] ** 1.5 - 1.0))


def test_a_second_grid_is_no_source_of_its_own_and_shares_add():
    near, far = (0.01 * (width**1.5 - 1.0) for width in WIDTHS)
    own = {"coarser_grid": {"x": near}, "coarsest_grid": {"x": far}, "doubled_step": {"x": 0.03}}
    factors = {
        "coarser_grid": (WIDTHS[0], 1.5), "coarsest_grid": (WIDTHS[1], 1.5),
        "doubled_step": (2.0, 2.0), "looser_diaphragm": (10.0, 1.0),
    }  # fmt: skip
    found = shares(own, factors, ["x"])
    assert set(found) == {"coarser_grid", "doubled_step"}
    assert found["coarser_grid"]["x"] == pytest.approx(0.0125)
    assert found["doubled_step"]["x"] == pytest.approx(0.01)
    assert error_bars(own, factors, ["x"])["x"] == pytest.approx(0.0225)
    assert observed_orders(own, factors) == {"coarser_grid": {"x": pytest.approx(1.5)}}
