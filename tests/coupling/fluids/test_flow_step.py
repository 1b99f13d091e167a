"""What is fixed in a flow's step: its volume."""

import numpy as np
import pytest

from coupling.fluids.openfoam.flow_step import FlowSettings, FlowStep
from coupling.ports import Cause, StepFailed


def test_a_volume_that_is_not_kept_is_refused():
    step = FlowStep(start=0.0, end=0.01, dt=0.01, previous_dt=0.0)
    settings = FlowSettings(closure=1e-12)
    step.refuse_open(np.array([1.0, -1.0 + 0.9e-12]), 1.0, settings)
    with pytest.raises(StepFailed, match=r"t = 0.01 s: .* volume by 1.1e-12 of it") as failure:
        step.refuse_open(np.array([1.0, -1.0 + 1.1e-12]), 1.0, settings)
    assert failure.value.cause is Cause.MESH
