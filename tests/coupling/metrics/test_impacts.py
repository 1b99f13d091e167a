"""Blows as impulses."""

import numpy as np
import pytest

from coupling.metrics.impacts import impacts

FREQUENCY, MASS = 1.25, 150.0
EIGHTH = 0.125 / FREQUENCY


def blows(step, *, width, impulse=20.0, at=(0.5, 0.93, 1.7), sway=0.0):
    """A rigid liquid's force with blows of a Gaussian's shape, ``width`` [s] its deviation."""
    time = np.arange(0.0, 2.4 + 0.5 * step, step)
    phase = 2.0 * np.pi * FREQUENCY * time
    body = np.stack([8.0 * np.cos(phase), 0.0 * time, -9.81 + 0.0 * time], axis=1)
    force = MASS * body
    force[:, 0] += sway * np.sin(phase)
    for number, when in enumerate(at):
        shape = np.exp(-0.5 * ((time - when) / width) ** 2) / (width * np.sqrt(2.0 * np.pi))
        force[:, 0] += (1.0 - 0.1 * number) * impulse * shape
    return impacts(time, force, body_force=body, mass=MASS, frequency=FREQUENCY)


@pytest.mark.parametrize(("step", "width"), [(0.01, 0.008), (0.005, 0.005), (0.001, 0.001)])
def test_blows_have_their_impulse_however_narrow(step, width):
    found = blows(step, width=width)
    assert found["number"] == 3
    assert found["impulse_max_Ns"] == pytest.approx(
        20.0, rel=1e-4
    )  # the trapezoidal rule at a step of 1.25 widths
    assert found["time_of_max_s"] == pytest.approx(0.5, abs=0.5 * EIGHTH)


def test_a_smooth_sway_has_what_it_changes_in_an_eighth():
    found = blows(0.001, width=0.01, at=(), sway=300.0)
    # int of sin over an eighth about its crest: 2 sin(pi/8)/omega.
    wanted = 300.0 * 2.0 * np.sin(np.pi / 8.0) / (2.0 * np.pi * FREQUENCY)
    assert found["impulse_max_Ns"] == pytest.approx(wanted, rel=1e-3)
    assert found["number"] == 6  # one to either side in each of three periods


def test_a_rigid_liquid_has_no_blow_and_a_short_run_none_to_tell():
    assert blows(0.01, width=0.01, at=()) == pytest.approx(
        {"impulse_max_Ns": 0.0, "time_of_max_s": 0.5 * EIGHTH, "number": 0}
    )
    time = np.array([0.0, 0.01, 0.02])
    body = np.tile([0.0, 0.0, -9.81], (3, 1))
    assert impacts(time, MASS * body, body_force=body, mass=MASS, frequency=FREQUENCY) is None
