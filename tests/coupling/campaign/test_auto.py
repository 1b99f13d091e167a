"""The model that a scene is left to choose: taken, run, and checked on the next one up."""

import json

import numpy as np
import pytest

from coupling.campaign.auto import FILE, path_error, resume_auto, run_auto
from coupling.estimate.model_errors import choose
from coupling.scene.scene import load_scene, scene_from
from coupling.simulation.driver import run

SCENE = {
    "tank": {"radius": 0.4445},
    "diaphragm": {"thickness": 0.001778, "material": "AF-E-332"},
    "liquid": {"name": "water", "fill_fraction": 0.8},
    "motion": {"kind": "sine", "frequency": 0.1, "acceleration": 1.0},
    "model": {"fluid": "auto", "tolerance": 0.2},
    "cloth": {"resolution": 8, "fold_damping": 1.0},
    "time": {"settle": 0.5, "periods": 1.5, "steps_per_period": 20, "checkpoint_every": 10},
}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    folder = tmp_path_factory.mktemp("auto") / "run"
    return folder, run_auto(scene_from(SCENE), folder)


def test_the_cheapest_good_enough_model_is_run_and_named(done):
    folder, summary = done
    assert summary["status"] == "completed"
    assert summary["model"] == choose(scene_from(SCENE)).fluid == "hydrostatic"
    assert load_scene(folder).model.fluid == "hydrostatic"
    assert json.loads((folder / "summary.json").read_text())["auto"] == summary["auto"]


def test_the_choice_is_checked_over_one_period_of_the_next_model(done):
    folder, summary = done
    checked = summary["auto"]["checked"]
    assert checked["against"] == "potential"
    assert checked["simulated_s"] == pytest.approx(10.0)
    # slow: (f/f1)^2 is 0.011, and a quick ramp adds a few times that
    assert 0.0 < checked["error"] < 0.2
    assert "within 0.2" in checked["says"]
    assert (folder / "check" / "results.h5").is_file()


def test_a_resumed_run_is_checked_too(done, tmp_path):
    folder, summary = done
    stored = json.loads((folder / FILE).read_text())
    del stored["checked"]
    (folder / FILE).write_text(json.dumps(stored))
    again = resume_auto(folder)
    del summary["auto"]["checked"]["wall_s"], again["auto"]["checked"]["wall_s"]
    assert again["auto"] == summary["auto"]


def test_a_run_stands_where_there_is_nothing_to_check_it_with(tmp_path):
    scene = scene_from(
        SCENE
        | {"motion": {"kind": "sine", "frequency": 0.35, "acceleration": 1.0}}
        | {"openfoam": {"command": "no-such-solver"}}
        | {"time": {"settle": 0.5, "duration": 0.2, "step": 0.05}}
        | {"model": {"fluid": "auto", "tolerance": 0.05}}  # (f/f1)^2 is 0.10
    )
    assert choose(scene).fluid == "potential"
    summary = run_auto(scene, tmp_path / "run")
    assert summary["status"] == "completed"
    assert summary["auto"]["checked"]["error"] is None
    says = summary["auto"]["checked"]["says"]
    assert says.startswith("not checked: openfoam failed: openfoam.command: must be")


def test_no_run_starts_before_a_model_is_chosen(tmp_path):
    with pytest.raises(ValueError, match="take a model first"):
        run(scene_from(SCENE), tmp_path)


def test_distance_of_two_paths():
    time = np.linspace(0.0, 1.0, 11)
    cg = np.zeros((11, 3))
    cg[:, 0] = np.sin(6.0 * time)
    assert path_error(time, cg, time, cg) == 0.0
    assert path_error(time[::2], 1.1 * cg[::2], time, cg) == pytest.approx(0.1)
    assert path_error(time, cg, time, np.zeros((11, 3))) is None
