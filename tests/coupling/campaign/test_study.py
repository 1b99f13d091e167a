"""Studies: reuse of finished runs, failures as rows, and the real driver on the cheap models."""

from __future__ import annotations

import json
from pathlib import Path

import known_run as run
import pytest
from small_scene import SMALL

from coupling.campaign.study import run_study
from coupling.campaign.study_plan import (
    coarsening,
    coarser_scenes,
    ladder_rows,
    less_resolved,
    stiffer,
    stretch_row,
    thesis_row,
)
from coupling.campaign.study_record import StudyRecord
from coupling.metrics.summary import summarise
from coupling.metrics.uncertainty import error_bars
from coupling.report import write_report
from coupling.report.page import percent
from coupling.scene.errors import SceneError
from coupling.scene.scene import Scene, load_scene, scene_toml, with_overrides
from coupling.store.atomic import write_json
from coupling.store.results import read_results


def with_model(scene: Scene, name: str) -> Scene:
    return scene.model_copy(update={"model": scene.model.model_copy(update={"fluid": name})})


def finished(folder: Path, scene: Scene, *, tilt: float, wall: float) -> None:
    """A finished run in ``folder``, whose diaphragm moves ``tilt`` times as far."""
    run.write_run(folder, scene=scene_toml(scene), model=scene.model.fluid, tilt=tilt)
    (folder / "scene.toml").write_text(scene_toml(scene))
    statistics = run.statistics()
    statistics.wall_s = wall
    content = summarise(read_results(folder), statistics, scene, "completed", None)
    write_json(folder / "summary.json", content)


def test_finished_runs_are_compared_without_running_anything(tmp_path: Path) -> None:
    scene = run.scene()
    for model, tilt, wall in (("datum", 3.0, 2.0), ("hydrostatic", 1.01, 4.0), ("openfoam", 1, 80)):
        finished(tmp_path / model, with_model(scene, model), tilt=tilt, wall=wall)
    [best] = ladder_rows(scene, ("openfoam",))
    for entry in (*less_resolved([best]), *stiffer([best])):
        finished(tmp_path / entry.place, entry.scene, tilt=1.02, wall=40.0)
    study = run_study(scene, ("openfoam", "datum", "hydrostatic"), tmp_path, quick=True)
    assert json.loads((tmp_path / "study.json").read_text()) == study
    assert study["reference"] == "openfoam"
    rows = study["models"]
    assert rows["hydrostatic"]["speedup"] == 20.0
    own = study["discretisation"]["coarser_grid"]["shape_rms"]
    # the distance is linear in the tilt: 2.0 away for datum, 0.02 and 0.01 for the others
    assert rows["datum"]["error"]["shape_rms"] == pytest.approx(100.0 * own)
    assert rows["hydrostatic"]["error"]["shape_rms"] == pytest.approx(0.5 * own)
    # 540 cells of 1216 at order 1.5, the doubled step at order 2, half the compliance: 0.02 away
    bar = own / ((1216 / 540) ** (1.5 / 3) - 1) + own / 3 + own / 0.5
    assert study["uncertainty"]["shape_rms"] == pytest.approx(bar)
    # the ratios get the same: p* and with it the neglected momentum go with the tilt
    fraction = study["bernoulli"]["dynamic_fraction"]
    variants = [
        json.loads(path.read_text())["bernoulli"]["dynamic_fraction"]
        for path in sorted((tmp_path / "discretisation").glob("*/*/summary.json"))
    ]
    grid, compliance, step = (abs(value - fraction["value"]) for value in variants)
    expected = grid / ((1216 / 540) ** (1.5 / 3) - 1) + step / 3 + compliance / 0.5
    assert fraction["uncertainty"] == pytest.approx(expected, abs=1e-15)
    assert fraction["value"] == rows["openfoam"]["bernoulli"]["dynamic_fraction"]
    assert rows["hydrostatic"]["below_reference_error"] == ["shape_rms"]
    assert rows["datum"]["below_reference_error"] == []
    assert study["advice"].startswith("Use hydrostatic")
    fronts = {(point["model"], point["resolution"]): point["on_front"] for point in study["points"]}
    assert "shape_rms" in fronts["datum", "as_run"]  # the fastest
    assert "shape_rms" in fronts["hydrostatic", "as_run"]
    assert "shape_rms" not in fronts["openfoam", "coarser_grid"]  # slower than hydrostatic, worse
    assert "shape_rms" in fronts["openfoam", "as_run"]
    text = (tmp_path / "report.html").read_text()
    assert f"≈ {percent(0.5 * own)} ± {percent(bar)}" in text
    assert "half the cells or fewer" in text
    assert "Speed against error" in text

    earlier = {key: study[key] for key in ("reference", "models", "discretisation", "advice")}
    earlier["models"] = {
        name: {key: row[key] for key in row if key != "model"} for name, row in rows.items()
    }
    write_json(tmp_path / "study.json", earlier)
    text = write_report(tmp_path).read_text()
    assert study["advice"] in text
    assert "Speed against error" not in text


def test_the_less_resolved_scenes_keep_the_instants_of_output() -> None:
    scene = run.scene()
    flow = coarser_scenes(with_model(scene, "openfoam"))
    assert scene.openfoam.cells == 1300  # that is a mesh of 1216
    assert flow["coarser_grid"].openfoam.cells == 540
    assert flow["coarser_grid"].cloth == scene.cloth
    time = flow["doubled_step"].time
    assert time.step * time.output_every == scene.time.step * scene.time.output_every
    cloth = coarser_scenes(with_model(scene, "hydrostatic"))["coarser_grid"]
    assert cloth.cloth.resolution == 17  # 24 rings over sqrt(2): half the triangles
    assert cloth.openfoam == scene.openfoam


def test_a_study_runs_only_scenes_that_can_be_read_again() -> None:
    """A doubled step beyond a twentieth of the period is not one; nor is half of an odd count."""
    longest = with_overrides(run.scene(), ["time.step=0.04", "time.duration=1.6"])  # of 0.8 s
    assert set(coarser_scenes(longest)) == {"coarser_grid", "halved_step"}
    scenes = [run.scene(), longest]
    for less in (less for scene in scenes for less in coarser_scenes(scene).values()):
        assert with_overrides(less, []) == less
    halved = coarser_scenes(longest)["halved_step"].time
    assert halved.step * halved.output_every == longest.time.step * longest.time.output_every
    # an error e at h is e/4 at h/2, of second order: they differ by 3/4 of it
    bars = error_bars({"halved_step": {"shape_rms": 0.03}}, coarsening(longest), ["shape_rms"])
    assert bars["shape_rms"] == pytest.approx(0.04)


def test_an_inextensible_reference_is_run_with_twice_its_stiffness() -> None:
    """An error in the compliance is halved: the two differ by half of it."""
    rows = ladder_rows(run.scene(), ("hydrostatic",))
    [entry] = stiffer(rows)
    assert entry.place == Path("discretisation/hydrostatic/doubled_stiffness")
    assert entry.scene == with_overrides(rows[0].scene, ["cloth.stiffness=200"])
    bars = error_bars(
        {"doubled_stiffness": {"shape_rms": 0.01}}, coarsening(rows[0].scene), ["shape_rms"]
    )
    assert bars["shape_rms"] == pytest.approx(0.02)
    own = with_overrides(run.scene(), ["diaphragm.inextensible=false"])
    assert not stiffer(ladder_rows(own, ("hydrostatic",)))


def test_a_model_that_the_scene_cannot_have_is_refused_before_anything_runs(tmp_path: Path) -> None:
    """It was a traceback from the thesis' cloth."""
    thesis = ['cloth.grid="thesis"', "cloth.resolution=10", 'model.fluid="datum"']
    with pytest.raises(SceneError, match=r"--models hydrostatic: cloth.grid"):
        run_study(with_overrides(run.scene(), thesis), ("datum", "hydrostatic"), tmp_path)
    assert not list(tmp_path.rglob("results.h5"))


def test_a_coarse_scene_with_half_the_cells_can_be_read_again() -> None:
    """The mesh below 540 cells has 176; below that there is none, and no coarser scene."""
    scene = with_overrides(run.scene(), ["model.fluid=openfoam", "openfoam.cells=540"])
    coarse = coarser_scenes(scene)["coarser_grid"].openfoam.cells
    assert with_overrides(scene, [f"openfoam.cells={coarse}"]).openfoam.cells == coarse == 176
    coarsest = with_overrides(scene, ["openfoam.cells=176"])
    assert "coarser_grid" not in coarser_scenes(coarsest)


SCENE = f"""\
{SMALL}[cloth]
resolution = 6
[time]
settle = 0.5
duration = 0.1
step = 0.005
"""


@pytest.fixture
def small(tmp_path: Path) -> Scene:
    (tmp_path / "scene.toml").write_text(SCENE)
    return load_scene(tmp_path / "scene.toml")


def test_a_real_study_of_the_cheap_models_runs_and_goes_on(small: Scene, tmp_path: Path) -> None:
    said: list[str] = []
    folder = tmp_path / "study"
    study = run_study(
        small,
        ("datum", "hydrostatic"),
        folder,
        progress=lambda stage, done, total, text: said.append(stage),
    )
    assert study["reference"] == "hydrostatic"
    assert list(study["models"]) == ["datum", "hydrostatic", "thesis", "compliant"]
    assert [row["status"] for row in study["models"].values()] == ["completed"] * 4
    assert study["models"]["compliant"]["model"] == "hydrostatic"
    assert 0.0 < study["models"]["compliant"]["against_same_model"]["shape_rms"] < 0.1
    assert study["models"]["thesis"]["error"]["shape_rms"] > 0.0  # on another mesh
    assert [(point["model"], point["resolution"]) for point in study["points"]] == [
        ("datum", "as_run"),
        ("hydrostatic", "as_run"),
        ("thesis", "as_run"),
        ("datum", "coarser_grid"),
        ("datum", "doubled_step"),
        ("thesis", "coarser_grid"),
        ("hydrostatic", "coarser_grid"),
        ("hydrostatic", "doubled_step"),
        ("hydrostatic", "doubled_stiffness"),
        ("datum", "coarsest_grid"),
        ("hydrostatic", "coarsest_grid"),
        ("hydrostatic", "looser_diaphragm"),
    ]
    assert all(point["cpu_s"] > 0.0 for point in study["points"])
    assert all(point["error"]["pressure_rms"] is not None for point in study["points"])
    expected = {"coarser_grid", "doubled_step", "doubled_stiffness", "looser_diaphragm"}
    assert set(study["discretisation"]) == expected | {"coarsest_grid"}
    assert study["observed_order"]["coarser_grid"]["shape_rms"] != 0.0
    numerical = {one["source"] for one in study["sources"] if one["kind"] == "numerical"}
    unknown = {one["source"] for one in study["sources"] if one["kind"] == "unknown"}
    assert numerical == expected
    assert unknown == {"compliant", "half_fold_damping", "other_rim", "friction"}
    moved = {one["source"]: one["share"]["shape_rms"] for one in study["sources"]}
    assert all(moved[name] > 0.0 for name in ("coarser_grid", "doubled_step", "compliant"))
    text = (folder / "report.html").read_text()
    assert "Where the error comes from" in text
    assert "What the words mean" in text
    assert study["models"]["hydrostatic"]["transient"] is True  # of a tenth of a second
    assert "The run is shorter than two periods" in text
    assert "Most of what hydrostatic itself errs by in the CG amplitude comes from its" in text
    assert "half the damping of folds below the grid" in text
    assert study["models"]["datum"]["error"]["shape_rms"] > 0.0
    assert any(stage.startswith("datum: ") for stage in said)
    assert (folder / "report.html").is_file()
    written = (folder / "datum" / "results.h5").stat().st_mtime_ns
    assert run_study(small, ("datum", "hydrostatic"), folder) == study
    assert (folder / "datum" / "results.h5").stat().st_mtime_ns == written


def test_a_failed_model_is_a_row(small: Scene, tmp_path: Path) -> None:
    broken = small.model_copy(
        update={"openfoam": small.openfoam.model_copy(update={"command": "/no/such/solver"})}
    )
    models = ("datum", "hydrostatic", "openfoam")
    study = run_study(broken, models, tmp_path / "study", quick=True)
    assert study["reference"] == "hydrostatic"
    assert study["models"]["openfoam"]["status"] == "failed"
    assert study["models"]["openfoam"]["failure"]
    assert study["models"]["openfoam"]["error"] == {}
    assert "failed" in (tmp_path / "study" / "report.html").read_text()


def test_a_rubber_that_loses_energy_is_compared_with_the_thesis_and_a_stiff_one(small: Scene):
    """Neither of which can lose what rubber does."""
    own = ("inextensible=false", "loss_factor=0.15", "friction_shell=0.3", "friction_self=0.3")
    lossy = with_overrides(small, [f"diaphragm.{key}" for key in own])
    thesis, stiff = thesis_row(lossy).scene, stretch_row(lossy, ["hydrostatic"]).scene
    assert thesis.diaphragm.friction_self == thesis.loss_time == stiff.loss_time == 0.0
    assert stiff.diaphragm.inextensible
    assert stiff.diaphragm.friction_shell == 0.3


def test_a_scene_that_the_thesis_cannot_have_is_a_row_too(small: Scene, tmp_path: Path) -> None:
    angles = [(polar, azimuth) for polar in (0, 45, 90) for azimuth in (0, 120, 240)]
    lines = [f"{polar},{azimuth},0.0018" for polar, azimuth in angles]
    (tmp_path / "ridges.csv").write_text("\n".join(["polar,azimuth,thickness", *lines]))
    mapped = with_overrides(small, [f"diaphragm.thickness_map={tmp_path / 'ridges.csv'}"])
    record = StudyRecord(tmp_path, ("datum", "hydrostatic"))
    with pytest.raises(SceneError, match="thickness_map"):
        thesis_row(mapped)
    record.add_impossible("thesis", "no map")
    assert record.to_dict()["models"]["thesis"]["failure"] == "no map"
