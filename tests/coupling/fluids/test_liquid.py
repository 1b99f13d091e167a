"""Which load and which mesh a scene gets."""

import numpy as np
import pytest
from water_tank import GRAVITY, RADIUS, scene

from cloth.shell.sphere import Sphere, level_of_fill_fraction
from coupling.fluids import FLUIDS
from coupling.fluids.datum import Datum
from coupling.fluids.hydrostatic import Hydrostatic
from coupling.fluids.openfoam.step import flow_of, start_flow
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm


def test_datum_is_zero_on_the_plane_at_the_level():
    shell = Sphere(RADIUS)
    model = Datum(density=1000.0, shell=shell)
    for force in (GRAVITY, np.array([12.0, 3.0, -9.81])):
        load = model.load(force, shell.volume_below(0.1))
        on_plane = -force / np.linalg.norm(force) * 0.1
        assert load.datum + 1000.0 * force @ on_plane == pytest.approx(0.0, abs=1e-8)
        assert load.volume is None


def test_load_model_follows_the_scene():
    datum = FLUIDS["datum"].load_model(scene())
    assert isinstance(datum, Datum)
    # Above the centre: 1/2 + 3h/4 - h^3/4 = 0.8 at h = 0.4257.
    load = datum.load(GRAVITY, scene().liquid_volume)
    assert load.datum / (load.density * 9.81 * RADIUS) == pytest.approx(0.42570, abs=1e-4)
    for fluid in ("hydrostatic", "openfoam"):
        model = FLUIDS[fluid].load_model(scene())
        assert isinstance(model, Hydrostatic)
        assert model.load(GRAVITY, 0.3).volume == 0.3


@pytest.mark.openfoam
@pytest.mark.parametrize("fill", [0.2, 0.8])
def test_flow_holds_the_liquid_below_the_free_part(tmp_path, fill):
    chosen = scene(liquid={"name": "water", "fill_fraction": fill}, openfoam={"cells": 200})
    cloth = diaphragm_of(chosen)
    load = FLUIDS["hydrostatic"].load_model(chosen).load(GRAVITY, chosen.liquid_volume)
    settle_diaphragm(cloth, chosen, load)
    flow, mapping = flow_of(chosen, tmp_path, cloth)
    assert flow.mesh.cells == 176
    start_flow(flow, mapping, chosen, cloth)
    assert flow.volume == pytest.approx(chosen.liquid_volume, rel=1e-11)
    assert flow.non_orthogonality_max < 50.0
    rim = flow.points[flow.mesh.rim, 2] / RADIUS
    level = level_of_fill_fraction(fill) - 1.0
    # On the shell where the sheet leaves it, which is not as sharp a bend as a liquid's surface.
    assert rim.mean() == pytest.approx(level, abs=0.1)
    flow.close()
