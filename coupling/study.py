"""Runs against runs: one scene on several rungs of the fluid ladder, errors against the best."""

from __future__ import annotations

import json
import logging
import shutil
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.atomic import write_json
from coupling.driver import resume, run
from coupling.metrics.advice import advice
from coupling.metrics.comparison import Errors, below, compare
from coupling.ports import RunFailed
from coupling.report import write_report
from coupling.results import read_results
from coupling.scene import Scene, load_scene, same_content
from coupling.scene_errors import SceneError
from coupling.scene_sections import LADDER

FILE = "study.json"
OWN_ERRORS = ("coarser_grid", "doubled_step")

Progress = Callable[[str, float, float, str], None]
_log = logging.getLogger(__name__)


def run_study(
    scene: Scene,
    models: Sequence[str],
    folder: Path | str,
    *,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run ``scene`` with each of ``models``, and the highest of them twice more, less resolved.

    Runs go to ``folder/<model>`` and ``folder/discretisation/<name>``. One that is complete there,
    of the same scene, is taken as it is; so a study that was stopped goes on. A model that fails
    is a row with its reason. ``study.json`` is written after every run, ``report.html`` at the end.
    Returns what ``study.json`` holds.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    summaries: dict[str, dict[str, Any]] = {}
    for name, place, variant in _planned(scene, models, folder, summaries):
        _log.info("study: %s in %s", name, place)
        summaries[name] = run_or_reuse(variant, place, _prefixed(progress, name))
        study = _study(scene, models, folder, summaries)
        write_json(folder / FILE, study)
    write_report(folder)
    return study


def _planned(
    scene: Scene, models: Sequence[str], folder: Path, done: Mapping[str, Mapping[str, Any]]
) -> Iterator[tuple[str, Path, Scene]]:
    """Cheapest model first; which one is the reference shows only when all have run."""
    for model in sorted(models, key=LADDER.index):
        yield model, folder / model, _with(scene, "model", fluid=model)
    best = reference_of(models, done)
    if best is not None:
        for name, variant in coarser_scenes(_with(scene, "model", fluid=best)).items():
            yield name, folder / "discretisation" / name, variant


def coarser_scenes(scene: Scene) -> dict[str, Scene]:
    """The scene with half the cells, and with the doubled step; the output's instants stay.

    Half the cells are half the flow's cells where there is a flow, else half the diaphragm's
    triangles: then the shapes cannot be compared node by node.
    """
    if scene.model.fluid == "openfoam":
        grid = _with(scene, "openfoam", cells=max(64, scene.openfoam.cells // 2))
    else:
        grid = _with(scene, "cloth", resolution=max(4, round(scene.cloth.resolution / 2**0.5)))
    every = scene.time.output_every
    step = _with(
        scene,
        "time",
        step=2.0 * scene.time.step,
        output_every=every // 2 if every % 2 == 0 else every,
        checkpoint_every=max(1, scene.time.checkpoint_every // 2),
    )
    return dict(zip(OWN_ERRORS, (grid, step), strict=True))


def _with(scene: Scene, section: str, **values: Any) -> Scene:
    return scene.model_copy(update={section: getattr(scene, section).model_copy(update=values)})


def run_or_reuse(scene: Scene, folder: Path, progress: Progress | None) -> dict[str, Any]:
    """Summary of ``scene`` run in ``folder``: of a complete run there, resumed, or made anew.

    One that fails is told by its ``status`` and ``error``. ``folder`` is emptied where it holds
    another scene.
    """
    try:
        if same_scene_there(scene, folder):
            known = read_summary(folder)
            if known.get("status") == "completed":
                return known
            if known.get("status") != "failed" and (folder / "checkpoint.h5").is_file():
                return resume(folder, progress=progress)
        if (folder / "scene.toml").is_file():
            shutil.rmtree(folder)
        return run(scene, folder, progress=progress)
    except RunFailed as error:
        return {**read_summary(folder), "status": "failed", "error": str(error)}


def same_scene_there(scene: Scene, folder: Path) -> bool:
    """Whether ``folder`` holds a run of ``scene``, however far that came."""
    if not (folder / "scene.toml").is_file():
        return False
    try:
        there = load_scene(folder)
    except SceneError:  # of another version, or a doubled step beyond the limit
        return False
    return same_content(scene, there)


def read_summary(folder: Path) -> dict[str, Any]:
    """``summary.json`` of a run's folder; empty where there is none."""
    path = folder / "summary.json"
    if not path.is_file():
        return {}
    content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return content


def _prefixed(progress: Progress | None, name: str) -> Progress | None:
    if progress is None:
        return None
    return lambda stage, done, total, text: progress(f"{name}: {stage}", done, total, text)


def reference_of(models: Sequence[str], summaries: Mapping[str, Mapping[str, Any]]) -> str | None:
    """The highest rung that has not failed, done or still to come."""
    ranked = sorted(models, key=LADDER.index, reverse=True)
    alive = [
        name for name in ranked if summaries.get(name, {}).get("status", "completed") == "completed"
    ]
    return alive[0] if alive else None


def _study(
    scene: Scene, models: Sequence[str], folder: Path, summaries: Mapping[str, Mapping[str, Any]]
) -> dict[str, Any]:
    best = reference_of(models, summaries)
    own = {
        name: errors_of(scene, folder / "discretisation" / name, folder, best, summaries[name])
        for name in OWN_ERRORS
        if name in summaries
    }
    rows: dict[str, Any] = {}
    for name in models:
        if name not in summaries:
            continue
        summary = summaries[name]
        errors = errors_of(scene, folder / name, folder, best, summary)
        rows[name] = {
            "status": summary.get("status"),
            "failure": summary.get("error"),
            "wall_s": summary.get("wall_s"),
            "error": errors,
            "speedup": _speedup(summaries.get(best or ""), summary),
            "below_reference_error": [] if name == best else below(errors, own),
            "bernoulli": summary.get("bernoulli"),
        }
    return {
        "reference": best,
        "models": rows,
        "discretisation": own,
        "advice": advice(best, rows),
    }


def errors_of(
    scene: Scene, run: Path, folder: Path, best: str | None, summary: Mapping[str, Any]
) -> Errors:
    """Errors of ``run`` against the run of ``folder`` that is named ``best``.

    Empty where the run or the reference is not complete. Raises ``RunFailed`` where the results
    of one cannot be read.
    """
    against = read_summary(folder / best) if best else {}
    if summary.get("status") != "completed" or against.get("status") != "completed":
        return {}
    reference = read_results(folder / str(best))
    return compare(read_results(run), summary, reference, against, scene.tank.radius)


def _speedup(best: Mapping[str, Any] | None, summary: Mapping[str, Any]) -> float | None:
    if not best or summary.get("status") != "completed" or not summary.get("wall_s"):
        return None
    return float(best["wall_s"]) / float(summary["wall_s"]) if best.get("wall_s") else None
