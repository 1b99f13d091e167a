"""``edt export``: the diaphragm at an instant as a surface for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from coupling.cli.exit_status import ExitStatus, guarded, stop


@guarded("coupling.store.surface")
def export(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")],
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", metavar="FILE",
            help="The surface, .ply (with pressures, slips and their works) or .stl, in metres.",
        ),
    ],
    time: Annotated[
        float | None,
        typer.Option(
            "--time", metavar="SECONDS",
            help="The written instant nearest to this is taken; the last one if not given.",
        ),
    ] = None,
) -> None:  # fmt: skip
    """Write the diaphragm at an instant of a run as a surface, and say which instant that is."""
    from coupling.store.results import open_results
    from coupling.store.surface import FORMATS, NoInstantError, write_surface

    if output.suffix not in FORMATS:
        known = ", ".join(sorted(FORMATS))
        stop(f"--output: must end in {known}, got '{output}'.", ExitStatus.WRONG_INPUT)
    try:
        taken = write_surface(open_results(folder), output, time)
    except NoInstantError as error:
        stop(f"--time: {folder} {error}", ExitStatus.WRONG_INPUT)
    typer.echo(f"{output}: the diaphragm at {taken:.6g} s")
