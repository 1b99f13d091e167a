"""A video of one period: the diaphragm in the tank, its pressure, the liquid's centre of gravity.

Written with matplotlib; MP4 by the ffmpeg that the package imageio-ffmpeg brings, a download of
70 MB where Debian's takes a hundred more packages; GIF without it.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
from matplotlib import rc_context
from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from coupling.ports import RunFailed, Shell
from coupling.report.picture import (
    PressureColours,
    draw_cg,
    draw_tank,
    last_period_rows,
    pressure_colours,
    pressure_scale,
)
from coupling.report.style import GREY, INK, LIGHT, house_style
from coupling.report.window import Window, by_record, liveliest
from coupling.store.results import Results

VIDEOS = frozenset({".gif", ".mp4"})
_INSTANTS = 100  # at most of a period
_RATE = 25.0  # instants a second at most of a longer window
_SECONDS = 4.0  # that it lasts at least
_DOTS = 100  # an inch: 640 by 800 pixels, of which video formats want even numbers


def render_video(
    results: Results, path: Path | str, window: Window | None = None, shell: Shell | None = None
) -> Path:
    """Write the last period as a video, ``.mp4`` or ``.gif``, and return its path.

    It is slowed down to four seconds where the period is shorter. Coloured by p*; models without a
    flow show the net pressure. A run of less than two periods is shown in its second half, one by
    a record in the ``liveliest`` second, and where a ``window`` [s] is given, that.
    ``shell``: the tank's, None for a sphere.

    Raises
    ------
    RunFailed
        The run has no instant yet, ffmpeg is missing, or the file could not be written.
    """
    path = Path(path)
    if not len(results.time):
        raise RunFailed(f"{path}: the run has no instant yet. Try again later.")
    most = _INSTANTS if window is None else max(_INSTANTS, round(_RATE * (window[1] - window[0])))
    rows = last_period_rows(results, most, window)
    shown = float(results.time[rows[-1]] - results.time[rows[0]])
    rate = max(1, round(len(rows) / max(_SECONDS, shown)))
    colours = pressure_colours(results, rows)
    with house_style(), rc_context({"animation.ffmpeg_path": _ffmpeg(path)}):
        figure = Figure(figsize=(6.4, 8.0))
        FigureCanvasAgg(figure)
        writer = _writer(path, rate)
        try:
            with writer.saving(figure, str(path), _DOTS):
                for row in rows:
                    figure.clear()
                    _draw(figure, results, rows, row, colours, window or liveliest(results), shell)
                    writer.grab_frame(facecolor="white")
        except subprocess.CalledProcessError as error:
            raise RunFailed(f"{path}: ffmpeg could not write it. {error.stderr or ''}") from error
    return path


def _ffmpeg(path: Path) -> str:
    if path.suffix == ".gif":
        return ""
    try:
        return str(imageio_ffmpeg.get_ffmpeg_exe())
    except RuntimeError as error:
        raise RunFailed(
            f"{path}: an MP4 needs ffmpeg, and imageio-ffmpeg has none for this machine. "
            "Install ffmpeg, or let the file end in .gif."
        ) from error


def _writer(path: Path, rate: int) -> AbstractMovieWriter:
    if path.suffix == ".gif":
        return PillowWriter(fps=rate)
    return FFMpegWriter(fps=rate, codec="h264", extra_args=["-crf", "20", "-pix_fmt", "yuv420p"])


def _draw(
    figure: Any,
    results: Results,
    rows: list[int],
    row: int,
    colours: PressureColours,
    span: Window | None,
    shell: Shell | None,
) -> None:
    axes = figure.add_axes((0.02, 0.25, 0.96, 0.75), projection="3d")
    draw_tank(axes, results, row, colours, shell)
    draw_cg(axes, results, rows, row)
    figure.text(0.03, 0.965, f"t = {results.time[row]:.3f} s", fontsize=14, color=INK)
    figure.text(0.97, 0.965, results.model, fontsize=11, color=GREY, ha="right")
    _draw_clock(figure.add_axes((0.14, 0.165, 0.8, 0.095)), results, row, span)
    pressure_scale(figure, (0.28, 0.06, 0.44, 0.013), colours)


def _draw_clock(axes: Any, results: Results, row: int, span: Window | None) -> None:
    """Where the tank is on its way, within ``span`` [s]; of a record how it is shaken."""
    shaken = by_record(results)
    moved = results.tank_acceleration if shaken else 1e3 * results.tank_displacement
    axis, time = int(np.argmax(np.ptp(moved, axis=0))), results.time
    axes.plot(time, moved[:, axis], color=LIGHT)
    axes.plot(time[: row + 1], moved[: row + 1, axis], color=INK)
    axes.plot(time[row], moved[row, axis], "o", color=INK)
    if span is not None:
        axes.set_xlim(*span)
    unit = "m/s²" if shaken else "mm"
    axes.set(xlabel="time (s)", ylabel=f"tank, {'xyz'[axis]} ({unit})")
    axes.grid(visible=False)
