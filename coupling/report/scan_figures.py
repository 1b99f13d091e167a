"""Maps of what a scan differs by from a run's diaphragm: from above, and on the mould unrolled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.tri import Triangulation

from coupling.metrics.places import mould_angles
from coupling.ports import Array, Ints
from coupling.report.page import Picture
from coupling.report.picture import DIVERGING
from coupling.report.rub_maps import graticule
from coupling.report.style import LIGHT, new_figure, svg

_DPI = 200  # of the colours, which are an image; lines and letters are not
_QUANTILE = 0.98  # of the differences, at which the colours end: a few would leave none to the rest
_POSES = {"as_given": "as given", "aligned": "aligned"}


def scan_maps(nodes: Mapping[str, Array], triangles: Ints) -> list[Picture]:
    """Vertical difference from above and distance on the mould, each as given and aligned.

    ``nodes``: the columns (n,) of ``compare.csv``; ``triangles`` (m, 3).
    """
    moulded, place = (
        np.stack([nodes[f"{prefix}_{axis}_m"] for axis in "xyz"], axis=1)
        for prefix in ("moulded", "run")
    )
    pictures = []
    for key, word in _POSES.items():
        values = 1e3 * nodes[f"vertical_{key}_m"]
        if np.isfinite(values).any():
            text = (
                f"Vertical difference, {word}: scan above the run's in red, below in blue, seen "
                "from above. Grey: nothing scanned, or too steep."
            )
            source = _from_above(place, triangles, values)
            pictures.append(Picture(source=source, caption=text, alt=text))
    for key, word in _POSES.items():
        text = (
            f"Nearest distance, {word}: scan on the gas side in red, on the liquid's in blue. The "
            "moulded shape unrolled: its pole in the middle, its rim outside, azimuth from x "
            "to y. Grey: nothing scanned."
        )
        source = _unrolled(moulded, triangles, 1e3 * nodes[f"normal_{key}_m"])
        pictures.append(Picture(source=source, caption=text, alt=text))
    return pictures


def _from_above(place: Array, triangles: Ints, values: Array) -> str:
    """``values`` (n,) [mm] where the nodes are, the upper layers in front."""
    upward = triangles[np.argsort(place[triangles, 2].mean(axis=1))]
    figure = new_figure(height=3.5)
    axes = figure.subplots()
    x, y = 1e3 * place[:, :2].T
    _colour(figure, axes, Triangulation(x, y, upward), values, "vertical difference (mm)")
    axes.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
    return svg(figure)


def _unrolled(moulded: Array, triangles: Ints, values: Array) -> str:
    """``values`` (n,) [mm] over the moulded shape."""
    polar, azimuth = mould_angles(moulded)
    x, y = np.degrees(polar) * np.cos(azimuth), np.degrees(polar) * np.sin(azimuth)
    figure = new_figure(height=3.5)
    axes = figure.subplots()
    _colour(figure, axes, Triangulation(x, y, triangles), values, "nearest distance (mm)")
    graticule(axes)
    return svg(figure)


def _colour(figure: Any, axes: Any, grid: Triangulation, values: Array, label: str) -> None:
    """Colour the triangles by the mean of their corners; grey where a corner has no value."""
    shown = values[grid.triangles].mean(axis=1)
    known = shown[np.isfinite(shown)]
    limit = float(np.quantile(np.abs(known), _QUANTILE)) if known.size else 1.0
    limit = limit or 1.0
    figure.set_dpi(_DPI)
    axes.tripcolor(
        grid, np.zeros(len(shown)), cmap=ListedColormap([LIGHT]), shading="flat", rasterized=True
    )
    grid.set_mask(~np.isfinite(shown))
    colours = axes.tripcolor(
        grid,
        np.where(np.isfinite(shown), shown, 0.0),
        shading="flat",
        cmap=DIVERGING,
        vmin=-limit,
        vmax=limit,
        rasterized=True,
    )
    bar = figure.colorbar(colours, shrink=0.8)
    bar.outline.set_visible(False)
    bar.set_label(label)
