"""The verb ``edt identify``."""

from __future__ import annotations

from pathlib import Path
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
    names,
    resumable,
)

if TYPE_CHECKING:
    from coupling.api.identification import Identification


def _numbers(listed: str) -> tuple[float, ...]:
    """The numbers in a list with commas."""
    try:
        return tuple(map(float, names(listed)))
    except ValueError:
        raise typer.BadParameter(
            f"must be numbers separated by commas, got '{listed}'. Give such as 0.2,0.5,0.8."
        ) from None


@guarded("coupling.api.identification", "coupling.cli.plain_table", "coupling.cli.progress")
def identify(
    scene_path: ScenePath,
    fill: Annotated[
        str, typer.Option("--fill", metavar="F,F", help="Fill fractions, separated by commas.")
    ],
    amplitude: Annotated[
        str,
        typer.Option(
            "--amplitude",
            metavar="A,A",
            help="Amplitudes of the tank's sway [m], centre to peak, separated by commas.",
        ),
    ],
    output: Output = None,
    changes: Changes = None,
    allow_command: AllowCommand = False,
    openfoam: OpenFoamPrefix = None,
    force: Force = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
) -> None:
    """Identify the pendulums that stand for a tank's liquid, at every fill and amplitude.

    Two sweeps of the tank's sway are run and fitted, and three scenes that the fit has not seen
    are held against it. Writes mechanical_model.json and .csv, a report, and exports for NASTRAN,
    FMI and Basilisk. The same command goes on with what was stopped.
    """
    from coupling import identify as identify_tank
    from coupling.cli.progress import RunProgress
    from coupling.store.run_folder import default_folder

    folder = output or default_folder(scene_path, "-identify")
    with resumable(folder, again()), RunProgress(unit="runs") as progress:
        done = identify_tank(
            scene_path,
            _numbers(fill),
            _numbers(amplitude),
            folder,
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
    if len(done.failures) == len(done.table["rows"]):
        first = next(iter(done.failures.values()))
        stop(f"{folder}: no model was identified. The first: {first}", ExitStatus.FAILED)


def _print(done: Identification, folder: Path) -> None:
    """One row a mode, each figure with its error; what is not followed below."""
    from coupling.cli.plain_table import figure, print_table

    def with_error(item: dict[str, float], name: str) -> str:
        return f"{figure(item[name])} +- {figure(item[f'{name}_error'], 2)}"

    columns = {
        "mass_kg": "mass [kg]",
        "frequency_hz": "frequency [Hz]",
        "damping_ratio": "damping ratio",
        "pendulum_length_m": "length [m]",
        "hinge_height_m": "hinge height [m]",
    }
    rows = []
    for row in done.table["rows"]:
        for place, mode in enumerate(row["modes"], start=1):
            head = [figure(row["fill_fraction"]), figure(row["amplitude_m"]), str(place)]
            rows.append((*head, *(with_error(mode, name) for name in columns)))
    title = f"modes of {done.table['model']}, in {folder}"
    print_table(title, ("fill", "amplitude [m]", "mode", *columns.values()), rows)
    limit = done.table["followed_within"]
    checks = [
        (
            f"{row['fill_fraction']:g}, {row['amplitude_m']:g} m: {check['says']}",
            figure(check["force_error"], 2),
            "failed" if check["failure"] else "yes" if check["followed"] else "no",
        )
        for row in done.table["rows"]
        for check in row["validation"]
    ]
    heads = ("scene that was not fitted", "rms error of the force", f"within {100 * limit:g} %")
    print_table("how well they are followed", heads, checks)
    for row in done.table["rows"]:
        error = row.get("left_out_error", {}).get(str(len(row["modes"])), 0.0)
        if error > done.table["linear_within"]:
            print(
                f"{row['condition']}: the model of one sweep misses the other by {error:.0%}: the "
                "motion is not linear. Sway less, or raise cloth.fold_damping."
            )
    for condition, failure in done.failures.items():
        print(f"{condition}: {failure}")
    print(f"report: {folder / 'report.html'}")
