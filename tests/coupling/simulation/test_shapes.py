"""A sphere given by its meridian, chosen by a scene's ``tank.shape``: the sphere's own answers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from arcs_tank import arcs_offered

from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.mesh import half_ball
from coupling.fluids.hydrostatic import Hydrostatic
from coupling.interface.free_patch import FreePatch
from coupling.scene.scene import Scene, SceneError, plain_values, scene_from, with_overrides
from coupling.simulation.driver import run
from coupling.store.results import Results, read_results
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm

RADIUS = 0.4445
# Both start 1e-16 R apart. The settled sheet is found to 1e-6 of rho g R^3, by iterations that
# contract what is apart; in a few steps of a gentle sway nothing snaps that would spread it.
SAME = 1e-9


@pytest.fixture(autouse=True)
def arcs() -> Iterator[None]:
    with arcs_offered():
        yield


def tank(fluid: str, **diaphragm: object) -> Scene:
    """A sheet that touches the shell, drawn along it by a sway."""
    return scene_from(
        {
            "tank": {"radius": RADIUS},
            "diaphragm": {"material": "AF-E-332", "thickness": 0.001778, **diaphragm},
            "liquid": {"name": "water", "fill_fraction": 0.7},
            "motion": {"kind": "sine", "frequency": 1.0, "amplitude": 0.05, "ramp": 0.0},
            "model": {"fluid": fluid},
            "cloth": {"resolution": 8},
            "time": {"duration": 0.1, "step": 0.01, "output_every": 1},
        }
    )


def both(scene: Scene, folder: Path) -> tuple[Results, Results]:
    """Results in the sphere and in the same sphere of arcs."""
    results = []
    for shape in ("sphere", "arcs"):
        summary = run(with_overrides(scene, [f"tank.shape={shape}"]), folder / shape)
        assert (summary["status"], summary["steps"]) == ("completed", 10)
        results.append(read_results(folder / shape))
    return results[0], results[1]


@pytest.mark.parametrize("fluid", ["hydrostatic", "potential", "datum"])
def test_a_run_in_a_sphere_of_arcs_is_that_in_the_sphere(tmp_path: Path, fluid: str):
    """With friction on the shell, so that the contact's every branch is taken."""
    wanted, got = both(tank(fluid, friction_shell=0.3), tmp_path)
    force = np.abs(wanted.force).max()
    np.testing.assert_allclose(got.position, wanted.position, atol=SAME * RADIUS)
    np.testing.assert_allclose(got.liquid_cg, wanted.liquid_cg, atol=SAME * RADIUS)
    np.testing.assert_allclose(got.force, wanted.force, atol=SAME * force)
    np.testing.assert_allclose(got.volume, wanted.volume, rtol=SAME)
    lifted = np.abs(wanted.position[-1] - wanted.position[0]).max()
    assert lifted > 1e-3 * RADIUS  # something moves


@pytest.mark.parametrize("fluid", ["hydrostatic", "potential"])
def test_a_run_in_points_of_a_sphere_and_in_a_pill_of_no_length_is_the_sphere_s(
    tmp_path: Path, fluid: str
):
    """A profile's circle has its radius from rounded points: apart by some 1e-15 R as well."""
    scene = with_overrides(tank(fluid, friction_shell=0.3), ["time.duration=0.05"])
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 33)
    points = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    lines = ["r,z", *(f"{r!r},{z!r}" for r, z in points.tolist())]
    (tmp_path / "sphere.csv").write_text("\n".join(lines))
    kept = plain_values(scene)
    shapes = {
        "sphere": {"radius": RADIUS},
        "pill": {"shape": "pill", "radius": RADIUS, "cylinder_length": 0.0},
        "profile": {"shape": "profile", "profile": str(tmp_path / "sphere.csv")},
    }
    results = {}
    for name, keys in shapes.items():
        assert run(scene_from(kept | {"tank": keys}), tmp_path / name)["status"] == "completed"
        results[name] = read_results(tmp_path / name)
    wanted = results["sphere"]
    for name in ("pill", "profile"):
        got, force = results[name], np.abs(wanted.force).max()
        np.testing.assert_allclose(got.position, wanted.position, atol=SAME * RADIUS)
        np.testing.assert_allclose(got.liquid_cg, wanted.liquid_cg, atol=SAME * RADIUS)
        np.testing.assert_allclose(got.force, wanted.force, atol=SAME * force)
        np.testing.assert_allclose(got.volume, wanted.volume, rtol=SAME)


def test_the_flow_s_mesh_in_a_sphere_of_arcs_is_that_in_the_sphere():
    """Of the settled sheet, its patch and the relaxed mesh below it, which stops at 1e-2 of its
    starting force after as many steps in both."""
    meshes = []
    for shape in ("sphere", "arcs"):
        scene = with_overrides(tank("openfoam"), [f"tank.shape={shape}"])
        cloth = diaphragm_of(scene)
        load = Hydrostatic(density=scene.liquid.density).load(
            np.array(scene.gravity), scene.liquid_volume
        )
        settle_diaphragm(cloth, scene, load)
        mesh, state = half_ball(200), cloth.state
        moulded = scene.mould.directions(cloth.reference)
        mapping = FreePatch(mesh, cloth, shell=scene.tank.shell, moulded=moulded)
        placed = mapping.begin_step(state, 0.0, state.position)
        shell, patch = placed.shell, placed.to_flow(state.position)
        following = FollowingMesh(mesh, scene.tank.shell)
        following.place(patch, following.raised(shell, patch, scene.liquid_volume))
        meshes.append(following.committed.points)
    np.testing.assert_allclose(meshes[1], meshes[0], atol=SAME * RADIUS)


def test_the_thesis_grid_wants_a_sphere():
    with pytest.raises(SceneError, match=r'tank.shape: must be "sphere" for cloth.grid = "thesis"'):
        with_overrides(
            tank("datum"), ["tank.shape=arcs", "cloth.grid=thesis", "cloth.resolution=12"]
        )


def test_an_unknown_shape_is_refused_with_the_known_ones():
    with pytest.raises(SceneError, match=r'tank.shape: .*"sphere".*got "cube"'):
        with_overrides(tank("datum"), ["tank.shape=cube"])
