"""A mesh below the settled diaphragm from nearly empty to nearly full, as OpenFOAM sees it."""

import numpy as np
import pytest
from test_case import check_mesh, figure

from coupling.fluids.hydrostatic import hydrostatic_of
from coupling.fluids.openfoam.step import flow_of, start_flow
from coupling.scene.scene import scene_from
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm

pytestmark = pytest.mark.openfoam


@pytest.mark.parametrize("fill", [0.1, 0.3, 0.8, 0.95])
def test_check_mesh_below_the_settled_diaphragm(tmp_path, fill):
    scene = scene_from(
        {
            "tank": {"radius": 0.4445},
            "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
            "liquid": {"name": "water", "fill_fraction": fill},
            "model": {"fluid": "openfoam"},
            "cloth": {"resolution": 10},
            "openfoam": {"cells": 540},
            "time": {"duration": 0.1},
        }
    )
    cloth = diaphragm_of(scene)
    gravity = np.array([0.0, 0.0, -9.81])
    settle_diaphragm(cloth, scene, hydrostatic_of(scene).load(gravity, scene.liquid_volume))
    flow, mapping = flow_of(scene, tmp_path / "foam", cloth)
    start_flow(flow, mapping, scene, cloth)
    text = check_mesh(flow, "-time", "0")
    assert "Mesh OK." in text
    assert figure(text, "Total volume = ") == pytest.approx(scene.liquid_volume, rel=1e-11)
    assert figure(text, "Mesh non-orthogonality Max: ") < 65.0
    flow.close()
