"""What is left of the pressure, carried forward by the order that served the last step best."""

import numpy as np
import pytest

from coupling.step.defects import Defects

FACES, STEP = 5, 0.01


def polynomial(degree, step):
    coefficient = np.random.default_rng(degree).normal(size=(degree + 1, FACES))
    return np.polynomial.polynomial.polyval(float(step), coefficient)


def test_nothing_is_known_before_the_first_step():
    assert (Defects().next(FACES, STEP) == np.zeros(FACES)).all()


@pytest.mark.parametrize("degree", [0, 1, 2])
def test_smooth_pressure_is_extrapolated_exactly(degree):
    defects = Defects()
    for step in range(5):
        defects.add(polynomial(degree, step), STEP)
    assert defects.next(FACES, STEP) == pytest.approx(polynomial(degree, 5), abs=1e-11)


def test_noise_is_not_amplified():
    # A quadratic turns alternating noise into seven times itself, a constant into twice.
    defects, noise = Defects(), np.ones(FACES)
    for step in range(6):
        defects.add((-1) ** step * noise, STEP)
    assert np.abs(defects.next(FACES, STEP)).max() <= 1.0


def test_order_follows_the_last_step():
    defects = Defects()
    for value in (0.0, 1.0, 2.0, 3.0):
        defects.add(np.full(FACES, value), STEP)
    assert defects.next(FACES, STEP) == pytest.approx(4.0)
    defects.add(np.full(FACES, 3.0), STEP)  # the slope is gone: a constant would have been right
    assert defects.next(FACES, STEP) == pytest.approx(3.0)


def test_restored_defects_go_on_bit_for_bit():
    one, two = Defects(), Defects()
    for step in range(6):
        one.add(polynomial(3, step), STEP)
    two.restore(one.save() | {"previous": np.zeros(3)})
    assert (one.next(FACES, STEP) == two.next(FACES, STEP)).all()
    for defects in (one, two):
        defects.add(polynomial(3, 6), STEP)
    assert (one.next(FACES, STEP) == two.next(FACES, STEP)).all()


def test_steps_of_another_length_tell_of_no_trend():
    defects = Defects()
    for value in (1.0, 2.0, 3.0):
        defects.add(np.full(FACES, value), STEP)
    assert defects.next(FACES, STEP) == pytest.approx(4.0)
    assert defects.next(FACES, STEP / 2) == pytest.approx(3.0)
    defects.add(np.full(FACES, 3.5), STEP / 2)
    assert defects.next(FACES, STEP) == pytest.approx(3.5)
    again = Defects()
    again.restore(defects.save())
    again.add(np.full(FACES, 4.0), STEP / 2)  # the first two of one length
    assert again.next(FACES, STEP / 2) == pytest.approx(4.0)
