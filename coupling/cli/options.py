"""What the verbs of the command line share: arguments, options, and checks before a start."""

from __future__ import annotations

import os
import shlex
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

from coupling.cli.exit_status import ExitStatus, stop
from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene

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
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON instead of a table.")]


def check_installed(scene: Scene, models: Sequence[str], *, start: bool = True) -> None:
    """See that what ``models`` need works before anything starts.

    With ``start`` false their programs are only looked for.
    """
    for name in models:
        if name in FLUIDS:  # not "auto", which takes one later
            FLUIDS[name].check_installed(scene, start=start)


def _allow_command(allowed: bool) -> None:
    from coupling.foam.installation import ALLOW_COMMAND

    if allowed:
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


def chosen_models(listed: str) -> tuple[str, ...]:
    """Two or more different fluid models from a list with commas; else the verb ends."""
    chosen = tuple(name.strip() for name in listed.split(","))
    unknown = [name for name in chosen if name not in FLUIDS]
    if unknown or len(set(chosen)) < max(2, len(chosen)):
        stop(
            f"--models: must be two or more different ones of {', '.join(FLUIDS)}, got '{listed}'.",
            ExitStatus.WRONG_INPUT,
        )
    return chosen


@contextmanager
def resumable(folder: Path, again: str = "") -> Iterator[None]:
    """Say how an interrupted run goes on: with the command ``again``, or from its checkpoint."""
    try:
        yield
    except KeyboardInterrupt:
        if not again:
            again = f"edt resume {shlex.quote(str(folder))}"
        stop(
            f"{folder}: interrupted; what was computed is kept. Go on with: {again}",
            ExitStatus.INTERRUPTED,
        )


def again() -> str:
    """The command as it was given, to be given again; without ``--force``."""
    return shlex.join(["edt", *(word for word in sys.argv[1:] if word != "--force")])
