"""OpenFOAM's flow in tanks that are no spheres, and in spheres that are given otherwise."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_case import check_mesh, figure

from coupling.fluids.hydrostatic import hydrostatic_of
from coupling.fluids.openfoam.step import flow_of, start_flow
from coupling.scene.scene import Scene, scene_from
from coupling.simulation.driver import run
from coupling.store.results import read_results
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm

pytestmark = pytest.mark.openfoam
RADIUS = 0.4445
PILL = {"shape": "pill", "radius": RADIUS, "cylinder_length": 2.0 * RADIUS}


def scene(tank: dict[str, Any], fill: float, cells: int, mould: str = "upper") -> Scene:
    return scene_from(
        {
            "tank": tank,
            "diaphragm": {"material": "AF-E-332", "thickness": 0.001778, "mould": mould},
            "liquid": {"name": "water", "fill_fraction": fill},
            "motion": {"kind": "sine", "frequency": 1.0, "amplitude": 0.2, "ramp": 0.0},
            "model": {"fluid": "openfoam"},
            "cloth": {"resolution": 8},
            "openfoam": {"cells": cells},
            "time": {"duration": 0.04, "step": 0.01, "output_every": 1, "settle_tolerance": 1e-5},
        }
    )


def test_a_flow_in_points_of_a_sphere_and_in_a_pill_of_no_length_is_the_sphere_s(tmp_path: Path):
    """To the coupling's tolerance of what moves; starts and iterations are apart by rounding."""
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 33)
    points = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    lines = ["r,z", *(f"{r!r},{z!r}" for r, z in points.tolist())]
    (tmp_path / "sphere.csv").write_text("\n".join(lines))
    shapes = {
        "sphere": {"radius": RADIUS},
        "pill": {"shape": "pill", "radius": RADIUS, "cylinder_length": 0.0},
        "profile": {"shape": "profile", "profile": str(tmp_path / "sphere.csv")},
    }
    results = {}
    for name, tank in shapes.items():
        chosen = scene(tank, 0.7, 200)
        assert run(chosen, tmp_path / name)["status"] == "completed"
        results[name] = read_results(tmp_path / name)
    wanted, tolerance = results["sphere"], chosen.coupling.tolerance
    moved = np.abs(wanted.position - wanted.position[0]).max()
    assert moved > 1e-3 * RADIUS
    for name in ("pill", "profile"):
        got = results[name]
        np.testing.assert_allclose(got.position, wanted.position, atol=tolerance * moved)
        np.testing.assert_allclose(got.liquid_cg, wanted.liquid_cg, atol=tolerance * moved)
        force = np.abs(wanted.force - wanted.force[0]).max()
        np.testing.assert_allclose(got.force, wanted.force, atol=10.0 * tolerance * force)


@pytest.mark.parametrize(("fill", "mould"), [(0.3, "lower"), (0.8, "upper")])
def test_check_mesh_below_a_diaphragm_in_a_pill(tmp_path: Path, fill: float, mould: str):
    """Twice as long as wide."""
    chosen = scene(PILL, fill, 540, mould)
    cloth = diaphragm_of(chosen)
    gravity = np.array(chosen.gravity)
    settle_diaphragm(cloth, chosen, hydrostatic_of(chosen).load(gravity, chosen.liquid_volume))
    flow, mapping = flow_of(chosen, tmp_path / "foam", cloth)
    start_flow(flow, mapping, chosen, cloth)
    text = check_mesh(flow, "-time", "0")
    assert "Mesh OK." in text
    assert figure(text, "Total volume = ") == pytest.approx(chosen.liquid_volume, rel=1e-11)
    assert figure(text, "Mesh non-orthogonality Max: ") < 50.0
    flow.close()
