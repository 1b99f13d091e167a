"""A diaphragm and its liquid at rest stay so, though every step is accepted as it is predicted."""

import numpy as np
import pytest
from conftest import SCENE, Edt

from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam


def test_pressure_at_rest_does_not_grow_from_step_to_step(edt: Edt, tmp_path):
    # Without the mismatch of the velocities it grows by half a step, to the coupling's tolerance.
    scene = tmp_path / "scene.toml"
    scene.write_text(
        SCENE.replace('kind = "sine"\nfrequency = 1.25\namplitude = 0.05', 'kind = "rest"')
    )
    done = edt(
        "run",
        scene,
        "-o",
        tmp_path / "run",
        "--set",
        "time.duration=0.2",
        "--set",
        "cloth.fold_damping=50.0",
    )
    assert done.returncode == 0, done.stderr
    run = read_results(tmp_path / "run")
    pressure = np.sqrt(np.mean(run.dynamic_pressure**2, axis=1))
    assert run.steps.iterations.max() == 1
    assert pressure[-10:].max() < pressure[1:10].max()
