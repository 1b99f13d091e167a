"""A free tank that its liquid moves by OpenFOAM: momentum, and a tank lighter than its liquid."""

import numpy as np
import pytest
from conftest import SCENE, Edt

from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam
PUSH, PUSHED = 60.0, 0.03  # N at the most, s


def test_light_tank_keeps_its_momentum_and_needs_no_more_iterations(edt: Edt, tmp_path):
    """A tenth of the liquid's mass, pushed and let be: no stagger drives it, whole steps suffice.

    The momentum P is kept to rounding: of three steps in a row 3 P - 4 P + P = 0, which is what the
    time scheme has of a momentum that nothing changes.
    """
    time = np.linspace(0.0, 1.0, 501)
    size = np.where(time < PUSHED, PUSH * np.sin(np.pi * time / PUSHED) ** 2, 0.0)
    rows = np.c_[time, size, 0.0 * time, 0.0 * time]
    head = "time (s),fx (N),fy (N),fz (N)"
    np.savetxt(tmp_path / "push.csv", rows, delimiter=",", header=head, comments="")
    scene = tmp_path / "scene.toml"
    scene.write_text(
        SCENE.replace('kind = "sine"\nfrequency = 1.25\namplitude = 0.05', 'kind = "rest"')
        + '\n[carrier]\nkind = "free"\nmass = 29.4\nforce_file = "push.csv"\n'
    )
    done = edt("run", scene, "-o", tmp_path / "run", "--set", "time.duration=0.08")
    assert done.returncode == 0, done.stderr
    steps = read_results(tmp_path / "run").steps
    momentum = steps.metrics["momentum_x"]
    after = steps.time[2:] > PUSHED + 0.011  # a table counts in the step after, too
    assert after.sum() > 5
    left = 3.0 * momentum[2:] - 4.0 * momentum[1:-1] + momentum[:-2]
    assert np.abs(left[after]).max() < 1e-10 * PUSH * PUSHED
    assert steps.iterations.max() <= 2
    pushed = np.abs(steps.tank_acceleration).max()
    assert np.abs(steps.tank_acceleration[-3:]).max() < 0.5 * pushed
