"""The coupling schemes on the same steps of a real flow, a hundred times the mass of the rubber."""

import numpy as np
import pytest

from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.ports import StepFailed
from coupling.scene.scene import scene_from
from coupling.simulation.driver import run
from coupling.step.remap import RemapSettings
from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam

TOLERANCE = 1e-4


SCENE = {
    "tank": {"radius": 0.4445},
    "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
    "liquid": {"name": "water", "fill_fraction": 0.8},
    "motion": {"kind": "sine", "frequency": 1.25, "amplitude": 0.25, "ramp": 0.5},
    "cloth": {"resolution": 8},
    "openfoam": {"cells": 176},
    "coupling": {"tolerance": TOLERANCE, "max_iterations": 60},
    "time": {"duration": 0.03, "step": 0.01, "output_every": 1},
}


def coupled(folder, scheme, tolerance=TOLERANCE):
    coupling = SCENE["coupling"] | {"scheme": scheme, "tolerance": tolerance}
    scene = scene_from(SCENE | {"coupling": coupling})
    return run(scene, folder), folder


@pytest.fixture(scope="module")
def best(tmp_path_factory):
    return coupled(tmp_path_factory.mktemp("added-mass"), "added-mass")


def test_added_mass_needs_few_iterations(best):
    summary, _ = best
    assert summary["status"] == "completed"
    assert summary["coupling"]["unconverged_steps"] == 0
    # The operator errs by some per cent per iteration: four of them make 1e-4 and more.
    assert summary["coupling"]["iterations_max"] <= 5
    assert summary["volume_error_max"] <= 1e-12


def test_a_map_made_anew_within_the_step_leads_to_the_same_motion(best, tmp_path, monkeypatch):
    monkeypatch.setitem(RemapSettings.__init__.__kwdefaults__, "slow", 0)
    summary, folder = coupled(tmp_path, "added-mass")
    assert summary["status"] == "completed"
    assert summary["coupling"]["unconverged_steps"] == 0
    assert summary["coupling"]["iterations_mean"] > best[0]["coupling"]["iterations_mean"]
    one, other = read_results(best[1]).liquid_cg, read_results(folder).liquid_cg
    # Both are converged to 1e-4 on the interface. The maps differ by how far the step ends from
    # where it was heading, a share of the step's own length of the order of dt times the rate.
    assert np.abs(one - other).max() < 1e-3 * np.abs(one - one[0]).max()


@pytest.mark.parametrize("method", ["liquid_inertia", "solve"])
def test_where_the_flow_has_no_mesh_half_the_way_is_taken(best, tmp_path, monkeypatch, method):
    # Of the map where the step begins, or of its first iterate.
    way = {}
    original = getattr(OpenFoamFlow, method)

    def shorter(flow, points, *motion):
        rise = np.median(np.abs(points - flow.points)[:, 2])  # along the sheet the points slide
        way.setdefault(flow.time, []).append(rise)
        if len(way[flow.time]) == 1:
            raise StepFailed("too far")
        return original(flow, points, *motion)

    monkeypatch.setattr(OpenFoamFlow, method, shorter)
    summary, folder = coupled(tmp_path, "added-mass")
    assert (summary["status"], summary["halved_steps"], summary["steps"]) == ("completed", 0, 3)
    assert summary["coupling"]["unconverged_steps"] == 0
    assert way[0.02][1] == pytest.approx(0.5 * way[0.02][0], rel=0.1)
    assert "half the way is tried: too far" in (folder / "log.txt").read_text()
    one, other = read_results(best[1]).liquid_cg, read_results(folder).liquid_cg
    # The map's share in the step's motion, as above.
    assert np.abs(one - other).max() < 1e-3 * np.abs(one - one[0]).max()


@pytest.mark.usefixtures("alive")
def test_a_step_that_fails_is_taken_in_parts(tmp_path, monkeypatch):
    # Parts are steps like others: the same as where all steps are as short, but for what the
    # coupling's tolerance leaves. The sheet's dissipation is that of all parts too.
    whole = SCENE | {"time": SCENE["time"] | {"step": 0.005, "output_every": 2}}
    wanted = run(scene_from(whole), tmp_path / "short")
    solve = OpenFoamFlow.solve

    def too_long(flow, points, motion):
        if flow.step.dt > 0.005:
            raise StepFailed("too long")
        return solve(flow, points, motion)

    monkeypatch.setattr(OpenFoamFlow, "solve", too_long)
    summary = run(scene_from(SCENE), tmp_path / "parts")
    assert (summary["status"], summary["halved_steps"], summary["steps"]) == ("completed", 3, 3)
    assert summary["coupling"]["unconverged_steps"] == 0
    means = [found["coupling"]["iterations_mean"] for found in (wanted, summary)]
    assert means[1] == pytest.approx(2 * means[0] + 1, abs=1)  # a whole step, once in vain
    assert "is taken as two: too long" in (tmp_path / "parts" / "log.txt").read_text()
    one, other = (read_results(tmp_path / name) for name in ("short", "parts"))
    assert one.time == pytest.approx(other.time)
    moved = np.abs(one.position - one.position[0]).max()
    assert np.abs(one.position - other.position).max() < 10 * TOLERANCE * moved
    for name in ("pressure_work", "dissipated_by_bending", "dissipated_by_drag"):
        values = [results.metrics[name][-1] for results in (one, other)]
        assert values[0] == pytest.approx(values[1], rel=1e-2), name


@pytest.mark.usefixtures("alive")
def test_a_step_that_fails_in_all_parts_ends_the_run(tmp_path, monkeypatch):
    def never(flow, points, motion):
        raise StepFailed(f"{flow.step.dt} s is too long")

    monkeypatch.setattr(OpenFoamFlow, "solve", never)
    summary = run(scene_from(SCENE), tmp_path)
    assert summary["status"] == "failed"
    assert "0.00125 s is too long" in summary["error"]  # a step of 0.01 s, halved three times


def share(one, other, moved):
    """Rms of ``one`` less ``other`` over that of ``moved``."""
    return float(np.linalg.norm(one - other) / np.linalg.norm(moved))


@pytest.mark.parametrize(
    ("step", "others"), [(0.01, ["iqn-ils"]), (0.005, ["iqn-ils", "aitken"]), (0.0025, ["iqn-ils"])]
)
def test_all_schemes_converge_to_the_same_motion(tmp_path, step, others):
    # The closure of the volume, taken for a motion, was an acceleration of some m/s^2, which
    # added-mass alone put on the liquid's inertia: its motion differed the more the shorter the
    # step. What differs now is the closure's second order, and what the cloth's inner iteration
    # leaves, with and without the liquid's inertia.
    found = {}
    for scheme in ("added-mass", *others):
        scene = SCENE | {
            "cloth": {"resolution": 8, "tolerance": 1e-9},
            "openfoam": {"cells": 176},
            "coupling": {"scheme": scheme, "tolerance": 1e-7, "max_iterations": 200},
            "time": SCENE["time"] | {"step": step},
        }
        summary = run(scene_from(scene), tmp_path / scheme)
        assert (summary["status"], summary["coupling"]["unconverged_steps"]) == ("completed", 0)
        found[scheme] = read_results(tmp_path / scheme), summary["coupling"]["iterations_mean"]
    one, fewest = found.pop("added-mass")
    for other, iterations in found.values():
        assert iterations > 2.5 * fewest
        moved = one.position[-1] - one.position[0]
        assert share(one.position[-1], other.position[-1], moved) < 1e-4
        assert (
            share(one.liquid_cg[-1], other.liquid_cg[-1], one.liquid_cg[-1] - one.liquid_cg[0])
            < 1e-4
        )
        assert share(one.dynamic_pressure, other.dynamic_pressure, one.dynamic_pressure) < 1e-4


def test_fixed_point_is_caught_diverging(tmp_path):
    summary, folder = coupled(tmp_path, "fixed-point")
    assert summary["status"] == "failed"
    assert "the coupling diverges" in summary["error"]
    assert "coupling.scheme = 'added-mass'" in summary["error"]
    assert len(read_results(folder).time) == 1  # the settled state stays readable
