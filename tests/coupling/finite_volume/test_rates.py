"""Rates of fluxes as OpenFOAM's ``backward`` takes them."""

import numpy as np
import pytest

from coupling.finite_volume.rates import FluxRate

STEP = 0.1


def volumes(time):
    """Swept until ``time``, at rest before 0; of a cubic the formula would be exact."""
    return np.array([time**4, 2 * time**4])


def test_second_order_from_the_third_step_on():
    errors = []
    for step in (STEP, STEP / 2):
        rate = FluxRate(2)
        for number in range(round(1 / step)):
            end = (number + 1) * step
            found = rate(volumes(end) - volumes(end - step), step, step if number else 0.0)
            rate.accept_step()
        errors.append(np.abs(found - [12.0, 24.0]).max())
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.2)


def test_uneven_steps_of_a_steady_rate():
    # Both formulas are exact for a flux that is linear in time; the Euler step's is forgotten then.
    rate, time, previous = FluxRate(1), 0.0, 0.0
    for dt in (STEP, STEP / 2, STEP / 8, STEP / 8, STEP, STEP / 2):
        found = rate(np.array([(time + dt) ** 2 - time**2]), dt, previous)
        rate.accept_step()
        time, previous = time + dt, dt
    assert found == pytest.approx(2.0, rel=1e-12)


def test_calls_repeat_and_are_restored():
    rate, other = FluxRate(2), FluxRate(2)
    rate(np.ones(2), STEP, 0.0)
    rate.accept_step()
    one = rate(np.zeros(2), STEP, STEP)
    assert (rate(np.zeros(2), STEP, STEP) == one).all()
    assert one == pytest.approx((-0.75 - 2.0) / STEP**2)  # the flux before the start is none
    other.restore(rate.save())
    assert (other(np.zeros(2), STEP, STEP) == one).all()
