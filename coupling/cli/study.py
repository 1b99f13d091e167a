"""The verb ``edt study``."""

from __future__ import annotations

from typing import Annotated

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
    ScenePath,
    again,
    names,
    resumable,
)


@guarded("coupling.api.studies", "coupling.cli.study_table", "coupling.cli.progress")
def study(
    scene_path: ScenePath,
    models: Annotated[
        str | None,
        typer.Option("--models", help="Fluid models, separated by commas; all if not given."),
    ] = None,
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
    openfoam: OpenFoamPrefix = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Run one scene on several fluid models: errors against the best, speed against error."""
    from coupling import study as run_study
    from coupling.cli.progress import RunProgress
    from coupling.cli.study_table import print_study
    from coupling.store.run_folder import default_folder

    folder = output or default_folder(scene_path, "-study")
    with resumable(folder, again()), RunProgress() as progress:
        done = run_study(
            scene_path,
            None if models is None else names(models),
            folder,
            quick=quick,
            changes=changes or (),
            force=force,
            progress=progress,
        )
    if as_json:
        print_json(done.table)
    else:
        print_study(done.table, folder)
