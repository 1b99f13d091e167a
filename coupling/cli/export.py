"""``edt export``: the diaphragm for other programs, at an instant or at all of them."""

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
            help="The surface in metres: .ply (with pressures, slips and their works) or .stl; "
            "or .vtkhdf, all instants with all that nodes and triangles carry (ParaView 5.12).",
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
    """Write the diaphragm of a run at an instant, or at all of them, and say which these are."""
    from coupling.store.results import open_results
    from coupling.store.surface import FORMATS, NoInstantError, instant_row, write_surface
    from coupling.store.vtkhdf import SUFFIX, write_instants

    moving = output.suffix == SUFFIX
    if not moving and output.suffix not in FORMATS:
        known = ", ".join(sorted((*FORMATS, SUFFIX)))
        stop(f"--output: must end in {known}, got '{output}'.", ExitStatus.WRONG_INPUT)
    if moving and time is not None:
        stop(f"--time: a {SUFFIX} holds all instants. Leave it out.", ExitStatus.WRONG_INPUT)
    results = open_results(folder)
    try:
        if moving:
            last = results.time[instant_row(results, None)]
            write_instants(results, output)
            said = f"{len(results.time)} instants, {results.time[0]:.6g} to {last:.6g} s"
        else:
            said = f"at {write_surface(results, output, time):.6g} s"
    except NoInstantError as error:
        stop(f"--time: {folder} {error}", ExitStatus.WRONG_INPUT)
    typer.echo(f"{output}: the diaphragm, {said}")
