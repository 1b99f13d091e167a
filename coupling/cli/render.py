"""``edt render``: a picture or a video of a run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from coupling.cli.exit_status import ExitStatus, guarded, stop

PICTURES = frozenset({".pdf", ".png", ".svg"})
DEFAULT = "period.mp4"


@guarded("coupling.report", "coupling.store.results")
def render(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            metavar="FILE",
            help=f"Video (.mp4, .gif) or picture (.png, .svg, .pdf); DIR/{DEFAULT} if not given.",
        ),
    ] = None,
    start: Annotated[
        float | None,
        typer.Option("--from", metavar="T", help="Show the run from this time on [s]."),
    ] = None,
    end: Annotated[
        float | None, typer.Option("--to", metavar="T", help="Show the run up to this time [s].")
    ] = None,
) -> None:
    """Show a run's last period: the diaphragm and its pressure, moving or at three instants.

    Of a run by a record the second in which the centre of gravity moves most; with --from and --to
    the part of the run between them.
    """
    from coupling.report import VIDEOS, render_picture, render_video
    from coupling.report.window import WindowError, window_of
    from coupling.scene.scene import load_scene
    from coupling.store.results import read_results
    from coupling.store.run_folder import check_reportable

    check_reportable(folder)
    if not (folder / "results.h5").is_file():
        stop(f"{folder}: is no run. Give the folder of one.", ExitStatus.WRONG_INPUT)
    path = output or folder / DEFAULT
    if path.suffix not in VIDEOS | PICTURES:
        known = ", ".join(sorted(VIDEOS | PICTURES))
        stop(f"--output: must end in {known}, got '{path}'.", ExitStatus.WRONG_INPUT)
    results = read_results(folder)
    try:
        window = window_of(results, start, end)
    except WindowError as error:
        stop(str(error), ExitStatus.WRONG_INPUT)
    draw = render_video if path.suffix in VIDEOS else render_picture
    typer.echo(draw(results, path, window, load_scene(folder).tank.shell))
