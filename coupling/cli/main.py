"""The command line: ``edt VERB``. Verbs check their input, call one function and print a table."""

from __future__ import annotations

from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from coupling.cli.exit_status import guarded, run_app
from coupling.cli.json_output import print_json
from coupling.cli.options import (
    AllowCommand,
    AsJson,
    Changes,
    Force,
    Output,
    RunFolder,
    ScenePath,
    check_installed,
    resumable,
)
from coupling.cli.progress import RunProgress
from coupling.cli.render import render
from coupling.cli.study import study
from coupling.cli.sweep import sweep
from coupling.cli.tables import (
    model_estimates,
    print_check,
    print_summary,
    print_table,
)
from coupling.cli.verify import verify
from coupling.estimate.model_errors import choose
from coupling.estimate.numbers import numbers_of
from coupling.finite_volume.mesh import cells_made
from coupling.motion.record_summary import record_summary
from coupling.ports import RunFailed
from coupling.scene.choices import AUTO
from coupling.scene.scene import SCENE_FILE, load_scene, tables_of
from coupling.scene.source import scene_file
from coupling.store.folder_lock import held
from coupling.store.resumption import SavedRun, saved_run
from coupling.store.run_folder import (
    check_reportable,
    check_resumable,
    check_scene_outside,
    default_folder,
    prepare_folder,
)

app = typer.Typer(
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command()(sweep)


def _version(asked: bool) -> None:
    if asked:
        typer.echo(f"diaphragm-tank {version('diaphragm-tank')}")
        raise typer.Exit


@app.callback()
def edt(
    _: Annotated[
        bool,
        typer.Option("--version", callback=_version, is_eager=True, help="Say the version."),
    ] = False,
) -> None:
    """Fluid-structure interaction of spherical elastomeric diaphragm tanks."""


@app.command()
@guarded
def run(
    scene_path: ScenePath,
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Settle the diaphragm, then shake the tank. Results go to runs/NAME unless -o says other."""
    scene = load_scene(scene_path, changes or ())
    if scene.model.fluid == AUTO:
        from coupling.campaign.auto import run_auto as run_scene

        choice = choose(scene)
        typer.echo(f"auto takes {choice.fluid}: {choice.reason}", err=True)
        check_installed(scene, [choice.fluid])
    else:
        from coupling.simulation.driver import run as run_scene

        check_installed(scene, [scene.model.fluid])
    folder = output or default_folder(scene_path)
    check_scene_outside(folder, [scene_file(scene_path), *tables_of(scene).values()])
    with held(folder):
        prepare_folder(folder, force=force)
        with resumable(folder), RunProgress() as progress:
            summary = run_scene(scene, folder, progress=progress)
        _finish(summary, folder, as_json)


@app.command()
@guarded
def resume(folder: RunFolder, allow_command: AllowCommand = False, as_json: AsJson = False) -> None:
    """Go on from the last checkpoint, with the results of a run that never stopped."""
    check_resumable(folder)
    with held(folder):
        scene = load_scene(folder)
        saved = saved_run(folder, scene)
        auto = (folder / "auto.json").is_file()
        if saved is not None and saved.finished is not None and not (auto and _unchecked(saved)):
            typer.echo(
                f"{folder}: finished; nothing is left to compute. To go on beyond "
                f"{scene.time.duration:g} s, raise time.duration in {folder / SCENE_FILE} first.",
                err=True,
            )
            _print(saved.finished, folder, as_json)
            return
        check_installed(scene, [scene.model.fluid])
        if auto:
            from coupling.campaign.auto import resume_auto as resume_run
        else:
            from coupling.simulation.driver import resume as resume_run

        with resumable(folder), RunProgress() as progress:
            summary = resume_run(folder, progress=progress)
        _finish(summary, folder, as_json)


def _unchecked(saved: SavedRun) -> bool:
    """Whether the check of the model that auto took is still to come."""
    return "checked" not in ((saved.finished or {}).get("auto") or {})


def _finish(summary: dict[str, object], folder: Path, as_json: bool) -> None:
    """Report and print a run; a run that failed is reported too, and then ends with status 1."""
    failure = str(summary.get("error")) if summary.get("status") == "failed" else ""
    if (folder / "results.h5").is_file():
        from coupling.report import write_report

        try:
            write_report(folder)
        except RunFailed as error:
            failure = failure or str(error)
    _print(summary, folder, as_json)
    if failure:
        raise RunFailed(failure)


def _print(summary: dict[str, object], folder: Path, as_json: bool) -> None:
    if as_json:
        print_json(summary)
    else:
        print_summary(summary, folder)


app.command()(study)


@app.command()
@guarded
def report(folder: RunFolder) -> None:
    """Build report.html again from the files of a run, a study or a sweep."""
    check_reportable(folder)
    from coupling.report import write_report

    typer.echo(write_report(folder))


app.command()(render)


@app.command()
@guarded
def check(
    scene_path: ScenePath,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    as_json: AsJson = False,
) -> None:
    """Check a scene; say how good each fluid model is for it and what it costs."""
    scene = load_scene(scene_path, changes or ())
    check_installed(scene, [scene.model.fluid], start=False)
    numbers, choice, record = numbers_of(scene), choose(scene), record_summary(scene)
    if as_json:
        print_json(
            {
                "title": scene.title,
                "numbers": numbers.to_dict(),
                "record": None if record is None else record.to_dict(),
                "models": model_estimates(scene),
                "cells": cells_made(scene.openfoam.cells),
                "advised": choice.fluid,
                "reason": choice.reason,
            }
        )
    else:
        print_check(scene, numbers, choice, record)


app.command(context_settings={"allow_extra_args": True, "ignore_unknown_options": True})(verify)


@app.command()
@guarded
def build_solver() -> None:
    """Build the flow solver that stays alive for a whole run, and is some ten times as fast."""
    from coupling.foam.build import build_solver as build
    from coupling.foam.installation import find_openfoam

    typer.echo(build(find_openfoam(), say=lambda what: typer.echo(f"{what} ...", err=True)))


@app.command()
@guarded
def info(as_json: AsJson = False) -> None:
    """Say which versions are here, what was found of OpenFOAM, and what is compiled."""
    from coupling.cli.environment import found

    values = found()
    if as_json:
        print_json(values)
    else:
        print_table("", ("", "found"), [(name, str(value)) for name, value in values.items()])


def main() -> None:
    """Entry point of ``edt``."""
    run_app(app)
