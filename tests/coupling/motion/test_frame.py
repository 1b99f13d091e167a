"""The frame of a run: gravity less what its origin does."""

from __future__ import annotations

import numpy as np
import pytest
from small_scene import SMALL

from coupling.motion.frame import Frame, frame_of
from coupling.motion.rest import RestMotion
from coupling.motion.sine import SineMotion
from coupling.scene.scene import load_scene

GRAVITY = np.array([0.0, 1.0, -9.81])


class Falling(RestMotion):
    """A tank that falls freely."""

    def step_acceleration(self, start: float, end: float, previous: float) -> np.ndarray:
        return GRAVITY


def test_a_tank_at_rest_has_gravity_and_one_that_falls_nothing():
    for motion, wanted in ((RestMotion(), GRAVITY), (Falling(), np.zeros(3))):
        frame = Frame(gravity=GRAVITY, motion=motion)
        np.testing.assert_array_equal(frame.body_force(0.3, 0.4, 0.1), wanted)


def test_the_frame_of_a_scene_is_that_of_its_sine(tmp_path):
    """Without a ramp the acceleration is -A omega^2 sin(omega t) along x from the start."""
    (tmp_path / "scene.toml").write_text(SMALL + "[time]\nduration = 0.1\n")
    frame = frame_of(load_scene(tmp_path, ["motion.ramp=0"]))
    assert isinstance(frame.motion, SineMotion)
    omega, end = 4.0 * np.pi, 0.07
    shaking = -0.002 * omega**2 * np.sin(omega * end)
    assert frame.body_force(0.06, end, 0.01) == pytest.approx([-shaking, 0.0, -9.81], rel=1e-13)
    assert frame.acceleration(0.06, end) == pytest.approx([shaking, 0.0, 0.0], rel=1e-13)
    assert frame.displacement(end)[0] == pytest.approx(0.002 * np.sin(omega * end), rel=1e-13)
