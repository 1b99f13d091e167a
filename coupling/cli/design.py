"""The verb ``edt design``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

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
    resumable,
)

if TYPE_CHECKING:
    from coupling import Design


@guarded("coupling.api.designs", "coupling.cli.tables", "coupling.cli.progress")
def design(
    scene_path: ScenePath,
    radius: Annotated[
        str,
        typer.Option(
            "--radius", metavar="VALUES", help="Radii [m]: start:stop:count[:log] or a,b,c."
        ),
    ],
    criterion: Annotated[
        str,
        typer.Option(
            "--criterion",
            metavar="NAME",
            help="folds: largest share of the diaphragm's area folded over (faces whose normal has "
            "turned by more than 90 degrees from the moulded one; 0.71 if it everts as a whole). "
            "self_rub: largest slip work per area on itself [J/m^2]. wear: largest depth worn off, "
            "by the upper diaphragm.wear_coefficient, over the thickness. burst: largest stress "
            "over diaphragm.strength.",
        ),
    ],
    limit: Annotated[
        float,
        typer.Option(
            "--limit", help="What the criterion's figure stays below, such as 0.5; no default."
        ),
    ],
    thickness: Annotated[
        str | None,
        typer.Option(
            "--thickness",
            metavar="LEAST:LARGEST",
            help="Where to look [m]; if not given from a quarter of the scene's thickness to "
            "twice that, below 0.0495 radii.",
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
    """Bracket by runs, for each radius, the least thickness of the rubber that keeps a limit.

    At each radius five thicknesses are run, then the bracket is halved until it is 5 % wide. The
    motion stays as the scene gives it, an amplitude in metres too. Where the figure does not fall
    with the thickness, that is said. The same command goes on with a search that was stopped; a
    run that fails is a row with its reason.
    """
    from coupling import design as run_design
    from coupling.cli.progress import RunProgress
    from coupling.store.run_folder import default_folder

    folder = output or default_folder(scene_path, "-design")
    with resumable(folder, again()), RunProgress(unit="runs") as progress:
        done = run_design(
            scene_path,
            radius,
            criterion,
            limit,
            folder,
            thickness=thickness,
            changes=changes or (),
            force=force,
            workers=workers,
            scheduler=scheduler,
            progress=progress,
        )
    if as_json:
        print_json(done.table)
    else:
        _print(done)
    runs = [run for row in done.table["rows"] for run in row["runs"]]
    if all(run["failure"] for run in runs):
        first = runs[0]["failure"]
        stop(f"{folder}: no run completed. The first: {first}", ExitStatus.FAILED)


def _print(done: Design) -> None:
    """One row a radius; what is to be said of it, and failures, below."""
    from coupling.cli.plain_table import figure, print_table

    table = done.table
    names = ("too_thin_m", "enough_m", "mass_kg", "wavelength_over_radius")
    rows = [
        (figure(row["radius_m"]), row["status"], *(figure(row[name]) for name in names))
        for row in table["rows"]
    ]
    heads = ("radius [m]", "", "too thin [m]", "enough [m]", "mass [kg]", "wavelength/R")
    print_table(f"{table['criterion']} below {table['limit']:g}, in {done.folder}", heads, rows)
    print(f"{table['criterion']}: {table['figure']}. {table['reservation']}")
    print(table["same"])
    for row in table["rows"]:
        for remark in row["remarks"]:
            print(f"radius {row['radius_m']:g} m: {remark}.")
        for run in row["runs"]:
            if run["failure"]:
                print(f"{run['point']}: {run['failure']}")
    print(f"tables: {done.folder / 'design.csv'}, {done.folder / 'runs.csv'}")
    print(f"report: {done.folder / 'report.html'}")
