"""The verbs ``edt run`` and ``edt resume``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from coupling.cli.exit_status import guarded
from coupling.cli.json_output import print_json
from coupling.cli.options import (
    AllowCommand,
    AsJson,
    Changes,
    Force,
    OpenFoamPrefix,
    Output,
    Report,
    RunFolder,
    ScenePath,
    resumable,
)

if TYPE_CHECKING:
    from coupling import Run
    from coupling.cli.progress import RunProgress

_WORKS_WITH = ("coupling.api.runs", "coupling.cli.tables", "coupling.cli.progress")


@guarded(*_WORKS_WITH, "coupling.simulation.driver")
def run(
    scene_path: ScenePath,
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    openfoam: OpenFoamPrefix = None,
    force: Force = False,
    report: Report = True,
    as_json: AsJson = False,
) -> None:
    """Settle the diaphragm, then shake the tank. Results go to runs/NAME unless -o says other."""
    from coupling import load_scene
    from coupling import run as run_scene
    from coupling.scene.choices import AUTO
    from coupling.store.run_folder import default_folder

    scene = load_scene(scene_path, changes or ())
    if scene.model.fluid == AUTO:
        from coupling.estimate.model_errors import choose

        choice = choose(scene)
        typer.echo(f"auto takes {choice.fluid}: {choice.reason}", err=True)
    folder = output or default_folder(scene_path)
    _show(
        folder,
        as_json,
        lambda progress: run_scene(
            scene_path, folder, changes=changes or (), force=force, report=report, progress=progress
        ),
    )


@guarded(*_WORKS_WITH, "coupling.simulation.driver", "coupling.store.resumption")
def resume(
    folder: RunFolder,
    allow_command: AllowCommand = False,
    openfoam: OpenFoamPrefix = None,
    report: Report = True,
    as_json: AsJson = False,
) -> None:
    """Go on from the last checkpoint, with the results of a run that never stopped."""
    from coupling import resume as resume_run

    done = _show(
        folder, as_json, lambda progress: resume_run(folder, report=report, progress=progress)
    )
    if done.was_complete:
        typer.echo(
            f"{folder}: finished; nothing is left to compute. To go on beyond "
            f"{done.scene.time.duration:g} s, raise time.duration in {folder}/scene.toml first.",
            err=True,
        )


def _show(folder: Path, as_json: bool, compute: Callable[[RunProgress], Run]) -> Run:
    """Compute, and print what came of it; of a run that failed too, before that is raised."""
    from coupling import FailedRun
    from coupling.cli.progress import RunProgress

    try:
        with resumable(folder), RunProgress() as progress:
            done = compute(progress)
    except FailedRun as failure:
        _print(failure.run.summary, folder, as_json)
        raise
    _print(done.summary, folder, as_json)
    return done


def _print(summary: Mapping[str, Any], folder: Path, as_json: bool) -> None:
    if as_json:
        print_json(summary)
    else:
        from coupling.cli.tables import print_summary

        print_summary(summary, folder)
