"""The verb ``edt study``."""

from __future__ import annotations

from typing import Annotated

import typer

from coupling.campaign.same_plan import check_same_plan
from coupling.campaign.study_plan import planned_runs, study_rows
from coupling.cli.exit_status import guarded
from coupling.cli.json_output import print_json
from coupling.cli.options import (
    AllowCommand,
    AsJson,
    Changes,
    Force,
    Output,
    ScenePath,
    again,
    check_installed,
    chosen_models,
    resumable,
)
from coupling.cli.progress import RunProgress
from coupling.cli.tables import print_study
from coupling.fluids import FLUIDS
from coupling.scene.scene import load_scene, tables_of
from coupling.scene.source import scene_file
from coupling.store.folder_lock import held
from coupling.store.run_folder import check_scene_outside, default_folder, prepare_folder

STUDY_RUNS = ("*", "discretisation/*/*")


@guarded
def study(
    scene_path: ScenePath,
    models: Annotated[
        str, typer.Option("--models", help="Fluid models, separated by commas.")
    ] = ",".join(FLUIDS),
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="Only the models, and the best one less resolved: no other resolutions, no "
            "thesis' algorithm, no diaphragm that stretches.",
        ),
    ] = False,
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Run one scene on several fluid models: errors against the best, speed against error."""
    chosen = chosen_models(models)
    scene = load_scene(scene_path, changes or ())
    planned = planned_runs(scene, chosen, quick=quick)
    check_installed(scene, chosen)
    folder = output or default_folder(scene_path, "-study")
    files = frozenset({"study.json", "report.html", "discretisation", *study_rows()})
    check_scene_outside(folder, [scene_file(scene_path), *tables_of(scene).values()], files)
    with held(folder):
        prepare_folder(folder, force=force, study=files)
        check_same_plan(folder, planned, STUDY_RUNS, force=force)
        from coupling.campaign.study import run_study

        with resumable(folder, again()), RunProgress() as progress:
            outcome = run_study(scene, chosen, folder, quick=quick, progress=progress)
    if as_json:
        print_json(outcome)
    else:
        print_study(outcome, folder)
