"""What the verbs of the command line share: arguments, options, and how to go on."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from coupling.cli.exit_status import ExitStatus, stop

ScenePath = Annotated[
    Path, typer.Argument(metavar="SCENE", help="Folder with scene.toml, or a scene file.")
]
RunFolder = Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")]
Output = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="DIR", help="Where the results go.")
]
Changes = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Change the scene; may be repeated."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace the run that the folder holds.")]
Report = Annotated[
    bool,
    typer.Option(
        "--report/--no-report", help="Write report.html as well; `edt report DIR` does it later."
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", min=1, metavar="N", help="Worker processes; else all cores."),
]
Scheduler = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Use a running Dask cluster that sees the same files, such as tcp://host:8786.",
    ),
]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]


def _allow_command(allowed: bool) -> None:
    if allowed:
        from coupling.foam.installation import ALLOW_COMMAND

        os.environ[ALLOW_COMMAND] = "1"  # worker processes inherit it


AllowCommand = Annotated[
    bool,
    typer.Option(
        "--allow-command",
        callback=_allow_command,
        expose_value=False,
        help="Let the scene's openfoam.command be any program, which is then started.",
    ),
]


def _take_openfoam(prefix: Path | None) -> None:
    if prefix is not None:
        from coupling.foam.prefixes import OpenFoamMissing, take

        try:
            take(prefix)  # worker processes inherit it
        except OpenFoamMissing as missing:
            raise typer.BadParameter(str(missing)) from missing


OpenFoamPrefix = Annotated[
    Path | None,
    typer.Option(
        "--openfoam",
        metavar="PREFIX",
        callback=_take_openfoam,
        expose_value=False,
        help="Take the OpenFOAM in this folder, whose etc/bashrc is sourced, rather than that of "
        "the PATH; `edt info` lists those found.",
    ),
]


def names(listed: str) -> tuple[str, ...]:
    """The names in a list with commas."""
    return tuple(name.strip() for name in listed.split(","))


@contextmanager
def resumable(folder: Path, again: str = "") -> Iterator[None]:
    """Say how an interrupted run goes on: with the command ``again``, or from its checkpoint."""
    try:
        yield
    except KeyboardInterrupt:
        from coupling.store.run_folder import holds_run

        if not again and not holds_run(folder):
            raise  # nothing has begun
        again = again or f"edt resume {shlex.quote(str(folder))}"
        stop(
            f"{folder}: interrupted; what was computed is kept. Go on with: {again}",
            ExitStatus.INTERRUPTED,
        )


def again() -> str:
    """The command as it was given, to be given again; without ``--force``."""
    return shlex.join(["edt", *(word for word in sys.argv[1:] if word != "--force")])
