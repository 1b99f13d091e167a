"""Runs against runs: one scene on several rungs of the fluid ladder, errors against the best."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from coupling.campaign.error_sources import coarsest, refined, with_unknowns
from coupling.campaign.study_plan import (
    THESIS,
    Entry,
    ladder_rows,
    less_resolved,
    stiffer,
    stretch_name,
    stretch_row,
    thesis_row,
)
from coupling.campaign.study_record import StudyRecord
from coupling.campaign.theory_checks import check_entries
from coupling.ports import RunFailed
from coupling.report import write_report
from coupling.scene.content import content_in, content_of
from coupling.scene.errors import SceneError
from coupling.scene.scene import Scene
from coupling.simulation.driver import resume, run
from coupling.simulation.warm_up import warm_up
from coupling.store.atomic import UnreadableFile, write_json
from coupling.store.folder_lock import held
from coupling.store.run_folder import clear_run
from coupling.store.run_record import is_whole, read_summary

FILE = "study.json"

Progress = Callable[[str, float, float, str], None]
_log = logging.getLogger(__name__)


def run_study(
    scene: Scene,
    models: Sequence[str],
    folder: Path | str,
    *,
    quick: bool = False,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run ``scene`` with each of ``models``, and hold them against the highest that completes.

    Besides, each of them less resolved, on two grids and with one step; the thesis' own algorithm,
    less resolved too; a diaphragm that stretches; each source of the reference's error
    (``error_sources``); and short runs that are held against theory (``theory_checks``). ``quick``
    leaves all that out but for the reference's less resolved runs, which say how well it knows its
    own figures.

    Runs go to ``folder/<row>`` and ``folder/discretisation/<row>/<resolution>``. One that is
    complete there, of the same scene, is taken as it is; so a study that was stopped goes on. A
    run that fails is a row with its reason. Before the first, all kernels are compiled, so that
    wall times hold none of that. ``study.json`` is written after every run, ``report.html`` at the
    end. Returns what ``study.json`` holds.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    record = StudyRecord(folder, models)
    rows = _rows(scene, models, record, quick=quick)
    warm = False
    for entry in _planned(rows, record, quick=quick):
        place = folder / entry.place
        if not (warm or is_complete(entry.scene, place)):
            if progress is not None:
                progress("warm-up", 0.0, 1.0, "compiling, before anything is timed")
            warm_up(row.scene for row in rows)
            warm = True
        _log.info("study: %s, %s in %s", entry.row, entry.resolution, place)
        record.add(entry, run_or_reuse(entry.scene, place, _prefixed(progress, entry)))
        write_json(folder / FILE, record.to_dict())
    write_report(folder)
    return record.to_dict()


def _rows(scene: Scene, models: Sequence[str], record: StudyRecord, *, quick: bool) -> list[Entry]:
    rows = ladder_rows(scene, models)
    if quick:
        return rows
    further: dict[str, Callable[[Scene], Entry]] = {
        THESIS: thesis_row,
        stretch_name(scene): partial(stretch_row, models=models),
    }
    for name, row in further.items():
        try:
            rows.append(row(scene))
        except SceneError as error:
            record.add_impossible(name, str(error))
    return rows


def _planned(rows: Sequence[Entry], record: StudyRecord, *, quick: bool) -> Iterator[Entry]:
    """Cheapest first; which row is the reference shows only when all have run."""
    yield from rows
    finished = record.completed()
    best = [entry for entry in finished if entry.row == record.reference]
    others = [entry for entry in finished if entry.row != record.reference]
    yield from less_resolved(best if quick else [*others, *best])
    yield from stiffer(best)
    if not quick:
        yield from coarsest(others)
        yield from refined(best)
        yield from with_unknowns(finished)
        yield from check_entries(rows[0].scene, record.models)


def run_or_reuse(scene: Scene, folder: Path, progress: Progress | None) -> dict[str, Any]:
    """Summary of ``scene`` run in ``folder``: of a complete run there, resumed, or made anew.

    One that fails has the ``status`` failed and an ``error``. Another scene's run is replaced.

    Raises
    ------
    FolderError
        Another process computes in ``folder``, or its checkpoint is of another scene.
    UnreadableFile
        A file of the run in ``folder`` is damaged.
    """
    if is_complete(scene, folder):
        return read_summary(folder)
    with held(folder):
        try:
            if same_scene_there(scene, folder) and read_summary(folder).get("status") != "failed":
                return resume(folder, scene=scene, progress=progress)
            clear_run(folder)
            return run(scene, folder, progress=progress)
        except UnreadableFile:
            raise
        except RunFailed as error:
            return {**read_summary(folder), "status": "failed", "error": str(error)}


def same_scene_there(scene: Scene, folder: Path) -> bool:
    """Whether ``folder`` holds a run of ``scene``, however far that came."""
    return (folder / "scene.toml").is_file() and content_in(folder) == content_of(scene)


def is_complete(scene: Scene, folder: Path) -> bool:
    """Whether ``folder`` holds a run of ``scene`` that has ended well."""
    return is_whole(read_summary(folder), scene.time.steps) and same_scene_there(scene, folder)


def _prefixed(progress: Progress | None, entry: Entry) -> Progress | None:
    if progress is None:
        return None
    name = str(entry.place)
    return lambda stage, done, total, text: progress(f"{name}: {stage}", done, total, text)
