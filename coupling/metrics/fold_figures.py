"""Figures of a run's folds: at every step, and of the whole run."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from coupling.metrics.folds import FoldFinder
from coupling.ports import Array, DiaphragmState, Ints
from coupling.scene.scene import Scene
from coupling.scene.wrinkles import grid_spacing, rings_to_resolve, shortest_wavelength

# Of every step, where the grid carries folds: number, the sharpest tenth's radius [m], the sharpest
# radius [m] and its place [deg].
_RESOLVED = ("fold_number", "fold_tenth_radius", "fold_radius", "fold_polar", "fold_azimuth")


def below_grid(scene: Scene) -> str | None:
    """Return why the folds of a scene are below its grid; None where it resolves them.

    That is where ``edt check`` would let ``cloth.wrinkling`` be resolved, and it is.
    """
    cloth, length = scene.cloth, scene.mould.length
    if cloth.wrinkling == "resolved" and cloth.grid == "rings":
        return None  # the scene's checks see to the rings
    wavelength = shortest_wavelength(scene.diaphragm, scene.liquid, np.array(scene.gravity))
    return (
        f"below the grid: to resolve the elasto-gravity wavelength of {wavelength:.3g} m takes "
        f'cloth.wrinkling = "resolved" and {rings_to_resolve(length, wavelength)} rings; the grid '
        f"has a spacing of {grid_spacing(length, cloth):.3g} m, and its folds are relaxed"
    )


class FoldFigures:
    """Gives at every step what is folded, of a diaphragm with ``reference`` and ``triangles``."""

    def __init__(self, scene: Scene, reference: Array, triangles: Ints) -> None:
        self._finder = FoldFinder(reference, triangles)
        self._resolved = below_grid(scene) is None

    def metrics(self, state: DiaphragmState) -> dict[str, float]:
        """Return the figures of a ``state`` by name: ``folded_area`` [m^2], ``layers_touch``.

        Where the grid resolves folds also their number, the sharpest radius [m] and its place [deg]
        in the moulded shape.
        """
        found = {
            "folded_area": self._finder.folded_area(state.position),
            "layers_touch": float(np.any(state.self_pressure > 0.0)),
        }
        if self._resolved:
            folds = self._finder.folds(state.position)
            radii, place = (folds.tenth_radius, folds.radius), self._finder.place(folds.node)
            values = (float(len(folds.ridges)), *radii, *place)
            found |= dict(zip(_RESOLVED, values, strict=True))
        return found


def fold_summary(
    time: Array,
    metrics: Mapping[str, Array],
    scene: Scene,
    finder: FoldFinder,
    position: Array | None,
) -> dict[str, Any]:
    """Return what ``summary.json`` says of the folds of a run.

    Parameters
    ----------
    time
        Instants of the steps (T,) [s].
    metrics
        Figures of every step by name, (T,) each.
    scene
        The run's scene.
    finder
        Of the run's diaphragm.
    position
        Where the run ended (n, 3) [m]; None where nothing was computed.

    Returns
    -------
    dict
        Numbers, the ridges at the end, the sharpest radius and where and when it was: null with a
        reason in ``below_grid`` where the grid does not resolve them. ``sharpest_tenth_radius_m``:
        the least that a tenth of the area was bent to. ``sharpest_radius_resolved``:
        whether it is at least the grid's spacing h; a smaller one is the grid's rather than the
        sheet's, as the curvature lacks a share of (h/radius)^2/12, and cannot exceed 2/h. The area
        folded over and whether layers touch are of what the grid shows, and null in runs
        without these figures.
    """
    reason = below_grid(scene)
    found: dict[str, Any] = dict.fromkeys(
        (
            "number_max", "number_end", "ridges_end_deg", "sharpest_tenth_radius_m",
            "sharpest_radius_m", "sharpest_radius_over_thickness", "sharpest_radius_resolved",
            "sharpest_place_deg",
            "sharpest_time_s",
            "folded_area_max_m2", "folded_area_max_fraction", "layers_touch",
            "layers_touch_share_of_steps",
        )
    )  # fmt: skip
    if "folded_area" in metrics and len(time):
        area = float(np.nanmax(metrics["folded_area"]))
        share = float(np.nanmean(metrics["layers_touch"]))
        found |= {
            "folded_area_max_m2": area, "folded_area_max_fraction": area / finder.area,
            "layers_touch": share > 0.0, "layers_touch_share_of_steps": share,
        }  # fmt: skip
    if reason is None and position is not None and "fold_number" in metrics:
        number, tenth, radius, polar, azimuth = (metrics[name] for name in _RESOLVED)
        step = int(np.nanargmin(radius))
        ridges = finder.folds(position).ridges
        spacing = grid_spacing(scene.mould.length, scene.cloth)
        found |= {
            "number_max": int(np.nanmax(number)), "number_end": len(ridges),
            "ridges_end_deg": [finder.place(int(node)) for node in ridges],
            "sharpest_tenth_radius_m": float(np.nanmin(tenth)),
            "sharpest_radius_m": float(radius[step]),
            "sharpest_radius_over_thickness": float(radius[step] / scene.diaphragm.thickness),
            "sharpest_radius_resolved": bool(radius[step] >= spacing),
            "sharpest_place_deg": [float(polar[step]), float(azimuth[step])],
            "sharpest_time_s": float(time[step]),
        }  # fmt: skip
    return found | {"below_grid": reason}
