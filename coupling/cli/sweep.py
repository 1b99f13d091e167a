"""The verb ``edt sweep``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from coupling.cli.exit_status import ExitStatus, guarded, stop
from coupling.cli.json_output import print_json
from coupling.cli.options import (
    AllowCommand,
    AsJson,
    Changes,
    Force,
    OpenFoamPrefix,
    Output,
    ScenePath,
    Scheduler,
    Workers,
    again,
    names,
    resumable,
)

if TYPE_CHECKING:
    from coupling import Sweep


@guarded("coupling.api.sweeps", "coupling.cli.tables", "coupling.cli.progress")
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
        str | None,
        typer.Option(
            "--models",
            help="Fluid models, separated by commas; hydrostatics and the next if not given, with "
            "--want the scene's own.",
        ),
    ] = None,
    want: Annotated[
        str | None,
        typer.Option(
            "--want",
            metavar="FIGURES",
            help="Figures of summary.json, separated by commas: their dotted names, of a list by "
            "index from 0: cg.amplitude_m.0,rubs.self_work_max_J_per_m2. sweep.csv then has one "
            "row a run with these alone, sweep.nc (netCDF) the same over the axes; one model is "
            "enough.",
        ),
    ] = None,
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    openfoam: OpenFoamPrefix = None,
    force: Force = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Run a scene over a grid of values: errors of fluid models against the best, or any figures.

    The same command goes on with a sweep that was stopped: what is complete is not run again.
    A model that fails at a point is a row with its reason.
    """
    from coupling import sweep as run_sweep
    from coupling.cli.progress import RunProgress
    from coupling.store.run_folder import default_folder

    folder = output or default_folder(scene_path, "-sweep")
    with resumable(folder, again()), RunProgress(unit="runs") as progress:
        done = run_sweep(
            scene_path,
            over,
            None if models is None else names(models),
            folder,
            want=() if want is None else names(want),
            changes=changes or (),
            force=force,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
        )
    if as_json:
        print_json(done.table)
    else:
        _print(done, folder)
    rows = done.table["rows"]
    if not any(one["failure"] is None for row in rows for one in row["models"].values()):
        first = rows[0]["failure"]
        stop(f"{folder}: no run completed. The first: {first}", ExitStatus.FAILED)


def _print(done: Sweep, folder: Path) -> None:
    """One row a point: values, f/f1, errors of the lesser models; failures below."""
    from coupling.cli.plain_table import figure, print_table

    outcome = done.table
    if outcome["wanted"]:
        _print_wanted(outcome, folder)
        return
    lesser = [name for name in outcome["models"] if name != outcome["reference"]]
    keys = [axis["key"] for axis in outcome["axes"]]
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
    for point, failure in done.failures.items():
        print(f"{point}: {failure}")
    print(f"report: {folder / 'report.html'}")


def _print_wanted(outcome: Mapping[str, Any], folder: Path) -> None:
    """One row a run: values, model, status, the figures that were wanted; failures below."""
    from coupling.campaign.sweep_rows import tidy
    from coupling.cli.plain_table import figure, print_table

    lines = [line for row in outcome["rows"] for line in tidy(row)]
    heads = [name for name in lines[0] if name != "failure"]
    print_table(f"in {folder}", heads, [[figure(line[name]) for name in heads] for line in lines])
    for line in lines:
        if line["failure"]:
            place = ", ".join(f"{axis['key']} {line[axis['key']]}" for axis in outcome["axes"])
            print(f"{place}, {line['model']}: {line['failure']}")
    print(f"tables: {folder / 'sweep.csv'}, {folder / 'sweep.nc'}")
    print(f"report: {folder / 'report.html'}")
