"""What a program calls: paths as text, failures as errors, arrays with units."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from known_run import write_run
from small_scene import SMALL

import coupling
from coupling.store.folder_lock import FolderError
from coupling.store.results_head import FILE
from coupling.store.results_layout import FIELDS, METRIC_UNITS, STEP_FIELDS

TINY = f"""{SMALL}[model]
fluid = "hydrostatic"
[cloth]
resolution = 6
[time]
duration = 0.02
step = 0.005
output_every = 1
"""


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    """A scene's folder; a run of it takes a tenth of a second."""
    folder = tmp_path / "tiny"
    folder.mkdir()
    (folder / "scene.toml").write_text(TINY)
    return folder


@pytest.fixture(scope="module")
def done(tmp_path_factory: pytest.TempPathFactory) -> coupling.Run:
    """A run made from paths as text, with a model and a value in place of the scene's own."""
    folder = tmp_path_factory.mktemp("api")
    (folder / "scene.toml").write_text(TINY)
    return coupling.run(
        str(folder), str(folder / "run"), fluid="datum", changes={"liquid.fill_fraction": 0.7}
    )


def test_all_that_is_public_can_be_imported_and_says_what_it_is() -> None:
    for name in coupling.__all__:
        assert getattr(coupling, name).__doc__, name
    assert set(coupling.__all__) <= set(dir(coupling))
    with pytest.raises(AttributeError, match="no attribute 'simulate'"):
        coupling.simulate  # noqa: B018 - the access itself is tested


def test_the_function_stays_where_its_modules_have_been_imported() -> None:
    """A folder ``coupling/run`` would take the place of the function once it is imported."""
    from coupling.api import runs

    assert coupling.run is runs.run


def test_a_run_has_arrays_with_units(done: coupling.Run) -> None:
    results = done.results
    assert done.summary["status"] == "completed"
    assert done.scene.model.fluid == results.model == "datum"
    assert done.scene.liquid.fill_fraction == 0.7
    assert results.time == pytest.approx([0.0, 0.005, 0.01, 0.015, 0.02])
    assert results.liquid_cg.shape == (5, 3)
    assert {name: results.units[name] for name in ("time", "force", "strain")} == {
        "time": "s", "force": "N", "strain": "-",
    }  # fmt: skip
    assert not (done.folder / "report.html").exists()
    assert done.write_report() == done.folder / "report.html"


def test_a_dataset_has_every_array_with_its_dimensions_and_units(tmp_path: Path) -> None:
    write_run(tmp_path)
    results = coupling.read_results(str(tmp_path))
    data = results.to_xarray()
    assert data.sizes == {
        "time": len(results.time), "step_time": len(results.steps.time), "axis": 3, "corner": 3,
        "node": len(results.reference), "triangle": len(results.triangles),
    }  # fmt: skip
    for name, _ in FIELDS.values():
        assert np.array_equal(data[name], getattr(results, name)), name
    for name, _ in STEP_FIELDS.values():
        assert np.array_equal(data[f"step_{name}"], getattr(results.steps, name)), name
    assert set(results.metrics) <= set(data.data_vars)
    assert {f"step_{name}" for name in results.steps.metrics} <= set(data.data_vars)
    assert data.step_liquid_cg.dims == ("step_time", "axis")
    assert data.step_force.attrs["units"] == "N"
    assert data.liquid_cg.sel(axis="z").values == pytest.approx(results.liquid_cg[:, 2])
    assert data.force.attrs["units"] == "N"
    assert data.strain.attrs["units"] == "1"
    assert data.attrs["model"] == results.model


def test_no_metric_has_the_name_of_a_field() -> None:
    """Both are variables of one dataset."""
    assert not set(METRIC_UNITS) & {name for name, _ in FIELDS.values()}


def test_a_scene_without_a_file_needs_a_folder(scene: Path, tmp_path: Path) -> None:
    held = coupling.load_scene(str(scene), {"tank.radius": np.float64(0.21)})
    assert held.tank.radius == 0.21
    with pytest.raises(FolderError, match=r"out: .* Give the folder"):
        coupling.run(held)
    run = coupling.run(held, tmp_path / "out")
    assert run.scene == held
    with pytest.raises(FolderError, match="holds a run"):
        coupling.run(held, tmp_path / "out")
    assert coupling.resume(str(tmp_path / "out")).was_complete


def test_a_run_that_fails_is_raised_with_what_it_left(
    scene: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from coupling.simulation import driver

    failed = {"status": "failed", "error": "t = 1 s: no mesh"}
    monkeypatch.setattr(driver, "run", lambda *_, **__: failed)
    with pytest.raises(coupling.FailedRun, match="t = 1 s: no mesh") as caught:
        coupling.run(scene, scene / "run")
    assert caught.value.run.summary is failed
    assert not (scene / "run" / FILE).exists()


def test_the_results_never_replace_the_scene(scene: Path) -> None:
    with pytest.raises(FolderError, match="would replace"):
        coupling.run(scene, scene, force=True)
    assert (scene / "scene.toml").read_text() == TINY


@pytest.mark.parametrize("models", [["hydrostatic"], ["hydrostatic", "water"], ["datum"] * 2])
def test_models_that_are_none_are_refused(scene: Path, models: list[str]) -> None:
    with pytest.raises(coupling.SceneError, match="two or more different ones"):
        coupling.study(scene, models, scene / "study")
    assert not (scene / "study").exists()


def test_a_study_is_a_table_over_its_models(tmp_path: Path) -> None:
    rows = {
        "hydrostatic": {"wall_s": 1.0, "speedup": 4.0, "error": {"cg_phase_deg": 3.0}},
        "openfoam": {"wall_s": 4.0, "speedup": 1.0, "error": {"cg_phase_deg": 0.0}},
        "thesis": {"wall_s": None, "speedup": None, "error": {}},
    }
    table = {
        "reference": "openfoam", "models": rows, "uncertainty": {"cg_phase_deg": 0.5},
        "advice": "take it",
    }  # fmt: skip
    data = coupling.Study(folder=tmp_path, table=table).to_xarray()
    assert data.cg_phase_deg.sel(model="hydrostatic") == 3.0
    assert np.isnan(data.wall_s.sel(model="thesis"))
    assert data.cg_phase_deg.attrs["units"] == "degree"
    assert data.cg_phase_deg_uncertainty == 0.5
    assert data.attrs["reference"] == "openfoam"


def test_a_sweep_is_a_table_over_its_axes(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The points that failed are NaN; the axes keep the order and the units of the scene's keys."""
    from coupling.campaign import sweep as campaign
    from coupling.campaign.sweep_rows import sweep_json

    def row(point: SimpleNamespace) -> dict[str, object]:
        frequency = point.values["motion.frequency"]
        none = {"cg": None, "bernoulli": None, "error": {}, "wall_s": None}
        fine = none | {"error": {"cg_amplitude": frequency / 10}, "wall_s": 1.0}
        return {
            "point": point.name, "values": point.values, "numbers": {"frequency_ratio": frequency},
            "reference": "potential", "failure": None if frequency < 2 else "potential: no",
            "models": {"hydrostatic": fine, "potential": fine if frequency < 2 else none},
        }  # fmt: skip

    def run_sweep(plan, folder, **_):  # type: ignore[no-untyped-def]
        return json.loads(json.dumps(sweep_json(plan, "", [row(one) for one in plan.points])))

    monkeypatch.setattr(campaign, "run_sweep", run_sweep)
    over = {"motion.frequency": np.array([2.0, 1.0]), "liquid.fill_fraction": [0.8]}
    done = coupling.sweep(str(scene), over, out=scene / "sweep")
    data = done.to_xarray()
    assert data.sizes == {"motion.frequency": 2, "liquid.fill_fraction": 1, "model": 2}
    assert list(data["motion.frequency"]) == [2.0, 1.0]
    assert data["motion.frequency"].attrs["units"] == "Hz"
    errors = data.cg_amplitude.sel({"model": "potential", "liquid.fill_fraction": 0.8})
    assert np.array_equal(errors, [np.nan, 0.1], equal_nan=True)
    assert data.frequency_ratio.squeeze().values == pytest.approx([2.0, 1.0])
    assert list(done.failures.values()) == ["potential: no"]


def test_the_command_calls_these_functions(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from typer.testing import CliRunner

    from coupling.cli.main import app

    seen = []

    def run(given, out, **options):  # type: ignore[no-untyped-def]
        seen.append((given, out, options["changes"]))
        return coupling.Run(folder=out, summary={"status": "completed"})

    monkeypatch.setattr(coupling, "run", run)
    changes = ["--set", "time.step=0.01"]
    assert CliRunner().invoke(app, ["run", str(scene), "-o", "x", *changes]).exit_code == 0
    assert seen == [(scene, Path("x"), ["time.step=0.01"])]
