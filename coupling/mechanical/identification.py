"""Runs, fits, checks and exports of a tank's mechanical model, restartable at any run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.campaign.parallel import Task, in_parallel
from coupling.campaign.study import Progress, is_complete
from coupling.campaign.time_left import TimeLeft
from coupling.estimate.cost import run_cost
from coupling.mechanical.apparent_mass import apparent_mass
from coupling.mechanical.exports.written import write_exports
from coupling.mechanical.modal_choice import choose
from coupling.mechanical.modal_model import ModalModel
from coupling.mechanical.plan import Condition, Planned
from coupling.mechanical.recording import Recording, recording_of
from coupling.mechanical.rows import failed_row, fitted_row, model_csv
from coupling.mechanical.validation import FOLLOWED, LINEAR, force_error
from coupling.report import write_report
from coupling.store.atomic import write_json, write_text
from coupling.store.run_record import read_summary

FILE, TABLE = "mechanical_model.json", "mechanical_model.csv"
Summary = Mapping[str, Any]


def identify_all(
    conditions: Sequence[Condition],
    folder: Path,
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Run what ``conditions`` plan into ``folder`` (absolute), then identify, check and export.

    A run that is complete in the folder is not repeated. A condition whose sweeps fail is a row
    with the reason; a run to check that fails is reported in its place. Returns what
    ``mechanical_model.json`` holds.

    Raises ``SweepError`` where no cluster answers, ``RunFailed`` where ``folder`` is not writable.
    """
    summaries = _run_all(conditions, folder, workers, scheduler, progress)
    found = [_identified(condition, folder, summaries) for condition in conditions]
    rows = [row for row, _ in found]
    _hold_against_others(conditions, found, folder, summaries)
    scene = conditions[0].scene
    content = {
        "title": scene.title,
        "model": scene.model.fluid,
        "gravity_m_s2": list(scene.gravity),
        "direction": scene.motion.unit_direction.tolist(),
        "radius_m": scene.tank.shell.size,
        "followed_within": FOLLOWED,
        "linear_within": LINEAR,
        "rows": rows,
    }
    write_json(folder / FILE, content)
    write_text(folder / TABLE, model_csv(rows))
    write_exports(folder, content)
    write_report(folder)
    return content


def _run_all(
    conditions: Sequence[Condition],
    folder: Path,
    workers: int | None,
    scheduler: str | None,
    progress: Progress | None,
) -> dict[Path, Summary]:
    """The summary of every run by its place; of a failure the status and the reason."""
    planned = [run for condition in conditions for run in condition.runs]
    done: dict[Path, Summary] = {
        run.place: read_summary(folder / run.place)
        for run in planned
        if is_complete(run.scene, folder / run.place)
    }
    waiting = {run.place: run for run in planned if run.place not in done}
    tasks = [
        Task(
            point=place.parent.name,
            model=run.scene.model.fluid,
            scene=run.scene,
            folder=folder / place,
            cost=run_cost(run.scene, run.scene.model.fluid),
        )
        for place, run in waiting.items()
    ]
    left, to_come = TimeLeft(), sum(task.cost for task in tasks)
    for task, summary in in_parallel(tasks, workers, scheduler):
        place = task.folder.relative_to(folder)
        done[place] = summary
        left.took(task.cost)
        to_come -= task.cost
        if progress is not None:
            text = f"{place.parent.name}: {place.name} {summary.get('status')}"
            progress("identify", len(done), len(planned), text + left.text(to_come))
    return done


def _identified(
    condition: Condition, folder: Path, summaries: Mapping[Path, Summary]
) -> tuple[dict[str, Any], ModalModel | None]:
    """Row and model of a condition; the model is None where a sweep failed."""
    sweeps = [run for run in condition.runs if run.fits]
    failures = [
        f"{run.name}: {summaries[run.place].get('error') or 'no reason was given'}"
        for run in sweeps
        if summaries[run.place].get("status") != "completed"
    ]
    if failures:
        return failed_row(condition, "; ".join(failures)), None
    recordings = [_recorded(run, folder) for run in sweeps]
    choice = choose(recordings, condition.mass, condition.band)
    model = choice.fit.model
    shown = apparent_mass(recordings, model, condition.band)
    row = fitted_row(condition, choice, shown)
    row["validation"] = [
        _held_against(run, model, folder, summaries) for run in condition.runs if not run.fits
    ]
    return row, model


def _recorded(run: Planned, folder: Path) -> Recording:
    return recording_of(run.name, run.scene, folder / run.place)


def _held_against(
    run: Planned, model: ModalModel, folder: Path, summaries: Mapping[Path, Summary]
) -> dict[str, Any]:
    """How well ``model`` follows a run: the force's relative error, and whether it is small."""
    known = {"name": run.name, "says": run.says}
    summary = summaries[run.place]
    if summary.get("status") != "completed":
        failure = summary.get("error") or "no reason was given"
        return known | {"force_error": None, "followed": None, "failure": failure}
    error = force_error(_recorded(run, folder), model)
    followed = None if error is None else error <= FOLLOWED
    return known | {"force_error": error, "followed": followed, "failure": None}


def _hold_against_others(
    conditions: Sequence[Condition],
    found: Sequence[tuple[dict[str, Any], ModalModel | None]],
    folder: Path,
    summaries: Mapping[Path, Summary],
) -> None:
    """Add to every row how its model follows the checks of the same fill's other amplitudes."""
    for condition, (row, model) in zip(conditions, found, strict=True):
        row["other_amplitudes"] = [
            {"amplitude_m": other.amplitude} | _held_against(run, model, folder, summaries)
            for other in conditions
            if other.fill_fraction == condition.fill_fraction and other is not condition
            for run in other.runs
            if model is not None and not run.fits
        ]
