"""The tank seen from the side: shell, diaphragm, pressure."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

from cloth.shell.sphere import Sphere
from coupling.ports import Array, Shell
from coupling.report.outline import SAMPLES, meridian, outline
from coupling.report.section_cut import horizontal
from coupling.report.style import GREY, INK, LIGHT, house_style
from coupling.report.window import Window, liveliest, rows_within
from coupling.store.results import Results

ELEVATION = 20.0
DIVERGING, SEQUENTIAL = "RdBu_r", "YlGnBu"  # colours of p*, and of the net pressure
_TURN = -18.0  # degrees off the plane of shaking, so that the surface is seen to have depth
_ROUNDING = 1e-12  # of the largest pressure: a p* below it is none
_LIGHT = np.array([-0.35, -0.55, 0.75])


def render_picture(
    results: Results, path: Path | str, window: Window | None = None, shell: Shell | None = None
) -> Path:
    """Write a picture of the diaphragm at three instants of a period, coloured by p*.

    The format follows the ending of ``path``. Models without a flow show the hydrostatic pressure.
    ``window`` [s]: the part of the run to show in place of a period. ``shell``: the tank's, None
    for a sphere.
    """
    rows = period_rows(results, 3, window)
    period = last_period_rows(results, len(results.time), window)
    with house_style():
        figure = Figure(figsize=(3.1 * len(rows), 3.9))
        FigureCanvasAgg(figure)
        colours = pressure_colours(results, rows)
        share = 1.0 / len(rows)
        for column, row in enumerate(rows):
            axes = figure.add_axes((column * share, 0.2, share, 0.8), projection="3d")
            draw_tank(axes, results, row, colours, shell)
            draw_cg(axes, results, period, row)
            text = f"t = {results.time[row]:.2f} s"
            figure.text((column + 0.5) * share, 0.2, text, ha="center", color=GREY)
        pressure_scale(figure, (0.32, 0.125, 0.36, 0.02), colours)
        figure.savefig(path, dpi=130, facecolor="white")
    return Path(path)


class PressureColours:
    """Colours of the nodes' pressure, the same at all instants; ``label`` says what it is.

    ``values`` (n,) [kPa] by the row of the instant.
    """

    def __init__(self, rows: list[int], values: Array, label: str, *, diverging: bool) -> None:
        self.values, self.label = dict(zip(rows, values, strict=True)), label
        # the few largest values would leave the rest without colour
        top = float(np.quantile(np.abs(values), 0.99)) if values.size else 1.0
        low, high = (-top, top) if diverging else (float(np.min(values, initial=0.0)), top)
        if high <= low:
            low, high = low - 1.0, low + 1.0
        self.mappable = ScalarMappable(
            Normalize(low, high), colormaps[DIVERGING if diverging else SEQUENTIAL]
        )


def pressure_colours(results: Results, rows: list[int]) -> PressureColours:
    """p* at the instants of ``rows`` where there is any, else the net pressure."""
    pressure, dynamic = results.pressure[rows], results.dynamic_pressure[rows]
    if np.any(dynamic):
        rounding = _ROUNDING * np.abs(pressure).max()
        dynamic = np.where(np.abs(dynamic) > rounding, dynamic, 0.0)
        label = "dynamic pressure p* (kPa)"
        return PressureColours(rows, dynamic / 1e3, label, diverging=True)
    return PressureColours(rows, pressure / 1e3, "net pressure (kPa)", diverging=False)


def pressure_scale(figure: Any, place: tuple[float, ...], colours: PressureColours) -> None:
    """Bar of the colours, named; ``place`` is its left, bottom, width and height in the figure."""
    axes = figure.add_axes(place)
    bar = figure.colorbar(colours.mappable, cax=axes, orientation="horizontal")
    bar.set_label(colours.label)
    bar.outline.set_visible(False)


def period_rows(results: Results, count: int, window: Window | None = None) -> list[int]:
    """Rows of ``count`` instants spread over the last period of the shaking, else over the run.

    The period is that of the tank's displacement, from its last two upward zero crossings; the
    first instant is a quarter later, where the tank is farthest out. A run too short for that,
    which also starts softly, is shown in its second half. A ``window`` [s] is shown from its first
    to its last instant; of a run by a record the ``liveliest`` one.
    """
    time, window = results.time, window or liveliest(results)
    if len(time) <= count and window is None:
        return list(range(len(time)))
    if window is not None:
        inside = rows_within(time, window)
        spread = np.linspace(0, len(inside) - 1, min(count, len(inside)))
        return [int(inside[round(place)]) for place in spread]
    upward = _upward_crossings(results)
    if len(upward) >= 2:
        begin, end = upward[-2:]
        share = 0.25 + np.arange(count) * (0.5 / (count - 1) if count == 3 else 1.0 / count)
        wanted = begin + share * (end - begin)
        if wanted[-1] > time[-1]:
            wanted = wanted - (end - begin)
    else:
        wanted = np.linspace(0.5 * (time[0] + time[-1]), time[-1], count)
    return [int(np.argmin(np.abs(time - instant))) for instant in wanted]


def last_period_rows(results: Results, most: int, window: Window | None = None) -> list[int]:
    """Rows of the last period, which ends with the run; of a run too short, its second half.

    Those of the ``window`` [s] where there is one; of a run by a record of the ``liveliest``. Where
    they are more than ``most``, every k-th, the last one among them.
    """
    time, upward = results.time, _upward_crossings(results)
    long_enough = len(upward) >= 2
    duration = upward[-1] - upward[-2] if long_enough else 0.5 * (time[-1] - time[0])
    rows = np.flatnonzero(time > time[-1] - duration * (1.0 - 1e-9))
    window = window or liveliest(results)
    if window is not None:
        rows = rows_within(time, window)
    every = -(-len(rows) // most)
    return [int(row) for row in rows[::-1][::every][::-1]] if len(rows) else [len(time) - 1]


def _upward_crossings(results: Results) -> list[float]:
    """Instants [s] before which the tank's displacement changes from negative to positive."""
    moved = results.tank_displacement
    along = moved[:, int(np.argmax(np.ptp(moved, axis=0)))]
    rows = np.flatnonzero((along[:-1] < 0.0) & (along[1:] >= 0.0))
    return [float(instant) for instant in results.time[rows]]


def seen_from(results: Results) -> tuple[float, float]:
    """Azimuth and elevation [degrees] of who looks across the direction of shaking."""
    along = horizontal(np.ptp(results.tank_displacement, axis=0))
    return float(np.degrees(np.arctan2(along[1], along[0]))) - 90.0 + _TURN, ELEVATION


def draw_tank(
    axes: Any,
    results: Results,
    row: int,
    colours: PressureColours,
    shell: Shell | None = None,
) -> None:
    """Shell outline and diaphragm at one instant, seen across the direction of shaking.

    Without a ``shell`` that of the sphere to which the diaphragm is moulded.
    """
    shell = shell or Sphere(float(np.linalg.norm(results.reference, axis=1).max()))
    widest, middle = float(meridian(shell, SAMPLES)[0][:, 0].max()), 0.5 * sum(shell.poles)
    half = max(widest, 0.5 * (shell.poles[1] - shell.poles[0]))
    azimuth, elevation = seen_from(results)
    axes.set_proj_type("ortho")
    axes.view_init(elev=elevation, azim=azimuth)
    axes.set_axis_off()
    axes.computed_zorder = False  # what is behind what is decided here
    axes.set(xlim=(-half, half), ylim=(-half, half), zlim=(middle - half, middle + half))
    axes.set_box_aspect((1, 1, 1), zoom=1.52)
    _draw_shell(axes, shell, azimuth)
    corners = results.position[row][results.triangles]
    shown = colours.values[row][results.triangles].mean(axis=1)
    faces = _lit(corners, colours.mappable.to_rgba(shown))
    edges = faces * [0.85, 0.85, 0.85, 1.0]  # opaque: what is behind would shine through the seams
    surface = Poly3DCollection(corners, facecolors=faces, edgecolors=edges, linewidths=0.4)
    surface.set_zorder(2)
    axes.add_collection3d(surface)


def draw_cg(axes: Any, results: Results, rows: list[int], row: int) -> None:
    """The liquid's centre of gravity at ``row``, and its path over ``rows``, in front of all."""
    axes.plot(*results.liquid_cg[rows].T, color=INK, linewidth=0.9, zorder=5)
    axes.plot(*results.liquid_cg[[row]].T, "o", color=INK, markersize=4.0, zorder=6)


def _draw_shell(axes: Any, shell: Shell, azimuth: float) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    turn, tilt = np.radians(azimuth), np.radians(ELEVATION)
    viewer = np.array([np.cos(tilt) * np.cos(turn), np.cos(tilt) * np.sin(turn), np.sin(tilt)])
    seen = outline(shell, viewer)
    axes.plot(*seen.T, color=INK, linewidth=1.1, zorder=4)
    rim = shell.size * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    towards = rim @ np.array([np.cos(turn), np.sin(turn), 0.0])
    for shown, order in ((towards >= 0.0, 3), (towards <= 0.0, 1)):
        half = np.where(shown[:, None], rim, np.nan)
        axes.plot(*half.T, color=GREY, linewidth=0.9, zorder=order)
    glass = Poly3DCollection([seen], facecolors=[LIGHT], alpha=0.18)
    glass.set_zorder(0)
    axes.add_collection3d(glass)


def _lit(corners: Array, colour: Any) -> Any:
    """Darken faces that look away from the light; both sides of the rubber are lit."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    facing = np.abs(normal @ _LIGHT) / (length * np.linalg.norm(_LIGHT))
    shaded = np.array(colour)
    shaded[:, :3] *= (0.62 + 0.38 * facing)[:, None]
    return shaded
