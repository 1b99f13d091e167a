"""A free tank that its liquid moves by OpenFOAM: momentum, and a tank lighter than its liquid."""

import numpy as np
import pytest
from conftest import SCENE, Edt

from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam
PUSH, PUSHED = 60.0, 0.03  # N at the most, s


def test_light_tank_keeps_its_momentum_and_needs_no_more_iterations(edt: Edt, tmp_path):
    """A tenth of the liquid's mass, pushed and let be: no stagger drives it, whole steps suffice.

    The momentum is kept to rounding; the time scheme forgets the push by a third in each step.
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
    done = edt("run", scene, "-o", tmp_path / "run", "--set", "time.duration=0.18")
    assert done.returncode == 0, done.stderr
    steps = read_results(tmp_path / "run").steps
    late = steps.time > PUSHED + 0.13  # 3^-25 is 1e-12, at steps of 5 ms
    assert late.sum() > 3
    momentum = steps.metrics["momentum_x"][late]
    assert np.abs(momentum / (0.5 * PUSH * PUSHED) - 1.0).max() < 1e-10
    assert steps.iterations.max() <= 2
    assert np.abs(steps.tank_acceleration[late]).max() < 0.2 * np.abs(steps.tank_acceleration).max()
