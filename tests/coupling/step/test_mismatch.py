"""The flow's acceleration beyond the structure's, from what former steps have left."""

import numpy as np
import pytest

from cloth.kinematics import kinematics
from coupling.step.mismatch import VelocityMismatch

STEPS = (0.01, 0.01, 0.004, 0.02)  # s


def test_it_is_the_difference_of_two_histories_that_end_at_one_velocity():
    random = np.random.default_rng(0)
    structure, flow = random.normal(size=(2, len(STEPS), 7, 3))  # velocities at the ends of steps
    mismatch, still = VelocityMismatch(), np.zeros((7, 3))
    assert not mismatch.acceleration(STEPS[0])
    for step, dt in enumerate(STEPS[:-1]):
        mismatch.add(structure[step] - flow[step], dt)
        ahead, previous = STEPS[step + 1], dt if step else 0.0
        ends = random.normal(size=(7, 3))
        of_both = [
            (ends - kinematics(ahead, previous, still, v[step], still, v[step - 1]).velocity_anchor)
            / kinematics(ahead, previous, still, v[step], still, v[step - 1]).b
            for v in (structure, flow)
        ]
        assert mismatch.acceleration(ahead) == pytest.approx(of_both[1] - of_both[0], abs=1e-9)


def test_restored_it_goes_on_bit_for_bit():
    one, two = VelocityMismatch(), VelocityMismatch()
    for value in (1.0, 2.5, -0.5):
        one.add(np.full((4, 3), value), 0.01)
    two.restore(one.save() | {"defect": np.zeros(3)})
    assert (one.acceleration(0.005) == two.acceleration(0.005)).all()
