"""How well the flow's mesh stands for the liquid."""

import numpy as np
import pytest

from coupling.metrics.mesh_fit import mesh_fit


def test_a_model_without_a_mesh_has_no_fit():
    assert mesh_fit({"speed_max": np.ones(3)}) is None


def test_rms_and_maximum_over_time():
    found = mesh_fit({
        "patch_distance": np.array([0.0, 3e-3, 4e-3]),
        "mesh_cg_offset": np.array([1e-3, -1e-3, 1e-3]),
        "non_orthogonality_max": np.array([30.0, 70.0, 50.0]),
    })  # fmt: skip
    assert found["patch_distance_rms_m"] == pytest.approx(5e-3 / np.sqrt(3.0))
    assert found["patch_distance_max_m"] == 4e-3
    assert found["cg_offset_rms_m"] == pytest.approx(1e-3)
    assert found["non_orthogonality_max_deg"] == 70.0
