"""The verb ``edt sweep``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from coupling.campaign.same_plan import check_same_plan
from coupling.campaign.sweep_plan import Plan, parse_axis, plan_sweep
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
from coupling.cli.tables import figure, print_table
from coupling.ports import RunFailed
from coupling.scene.scene import tables_of
from coupling.scene.source import scene_file
from coupling.store.folder_lock import held
from coupling.store.run_folder import check_scene_outside, default_folder, prepare_folder

SWEEP_FILES = frozenset({"sweep.json", "sweep.csv", "report.html", "points"})


@guarded
def sweep(
    scene_path: ScenePath,
    over: Annotated[
        list[str],
        typer.Option(
            "--over",
            metavar="KEY=VALUES",
            help="Vary a key of the scene: key=start:stop:count, key=start:stop:count:log "
            "(geometric) or key=a,b,c. May be repeated: all combinations are run.",
        ),
    ],
    models: Annotated[
        str, typer.Option("--models", help="Fluid models, separated by commas.")
    ] = "hydrostatic,potential",
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    force: Force = False,
    workers: Annotated[
        int | None,
        typer.Option("--workers", min=1, metavar="N", help="Worker processes; else all cores."),
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            "--scheduler",
            metavar="ADDRESS",
            help="Use a running Dask cluster that sees the same files, such as tcp://host:8786.",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene over a grid of values on several fluid models: errors against the best, as maps.

    The same command goes on with a sweep that was stopped: what is complete is not run again.
    A model that fails at a point is a row with its reason.
    """
    chosen = chosen_models(models)
    plan = plan_sweep(scene_path, changes or (), [parse_axis(text) for text in over], chosen)
    for point in plan.points:
        for model, scene in point.scenes.items():
            check_installed(scene, [model])
    folder = output or default_folder(scene_path, "-sweep")
    runs = plan.runs
    files = {path for scene in runs.values() for path in tables_of(scene).values()}
    check_scene_outside(folder, [scene_file(scene_path), *files], SWEEP_FILES)
    with held(folder):
        prepare_folder(folder, force=force, study=SWEEP_FILES)
        check_same_plan(folder, runs, ("points/*/*",), force=force)
        from coupling.campaign.sweep import run_sweep

        with resumable(folder, again()), RunProgress(unit="runs") as progress:
            outcome = run_sweep(
                plan, folder, workers=workers, scheduler=scheduler, progress=progress
            )
    if as_json:
        print_json(outcome)
    else:
        _print(plan, outcome, folder)
    if not any(row["reference"] for row in outcome["rows"]):
        raise RunFailed(f"{folder}: no run completed. The first: {outcome['rows'][0]['failure']}")


def _print(plan: Plan, outcome: Mapping[str, Any], folder: Path) -> None:
    """One row a point: values, f/f1, errors of the lesser models; failures below."""
    lesser = [name for name in plan.models if name != outcome["reference"]]
    keys = [axis.key for axis in plan.axes]
    rows = []
    for row in outcome["rows"]:
        errors = [row["models"][name]["error"] for name in lesser]
        rows.append(
            (
                *(figure(row["values"][key]) for key in keys),
                figure(row["numbers"]["frequency_ratio"], 3),
                *(figure(error.get("cg_amplitude"), 3) for error in errors),
                *(figure(error.get("shape_rms"), 3) for error in errors),
                "failed" if row["failure"] else "",
            )
        )
    heads = [f"{name} {what}" for what in ("CG", "shape") for name in lesser]
    title = f"errors against {outcome['reference']}, in {folder}"
    print_table(title, (*keys, "f/f1", *heads, ""), rows)
    for row in outcome["rows"]:
        if row["failure"]:
            print(f"{row['point']}: {row['failure']}")
    print(f"report: {folder / 'report.html'}")
