"""The folds: how many, where, how sharp, and what is folded over."""

from __future__ import annotations

from typing import Any

from coupling.metrics.folds import FoldFinder
from coupling.report.files import RunFiles
from coupling.report.page import Picture, Section, Table, number, percent
from coupling.report.rub_maps import mould_map

_NOTE = (
    "A fold is a ridge: a maximum of the larger principal curvature along a ring of the grid, that "
    "rises by more than 1/R above its sides; the ring with most counts. Folded over is rubber "
    "whose normal has turned by more than 90° from the moulded one, 71\u202f% of a wholly everted "
    "hemisphere."
)


def fold_section(run: RunFiles) -> Section | None:
    """The table, and a map of the curvature at the end; None for a run without these figures."""
    folds = run.summary.get("folds")
    if folds is None or folds["folded_area_max_fraction"] is None:
        return None
    return Section(
        title="Folds", text=_below(folds["below_grid"]), tables=[fold_table(folds)],
        pictures=_curvature_map(run, folds),
    )  # fmt: skip


def _below(reason: str | None) -> str:
    return "" if reason is None else f"Number and sharpness are {reason}."


def fold_table(folds: dict[str, Any]) -> Table:
    """Return a table of a summary's ``folds``."""
    rows = []
    if folds["number_max"] is not None:
        places = ", ".join(_place(ridge) for ridge in folds["ridges_end_deg"]) or "none"
        radius = number(1e3 * folds["sharpest_radius_m"], "mm")
        if not folds["sharpest_radius_resolved"]:
            radius += ", below the grid’s spacing: not resolved"
        rows += [
            ["Folds, most", str(folds["number_max"])],
            ["Folds at the end", str(folds["number_end"])],
            ["… from the moulded pole, azimuth", places],
            ["The sharpest tenth is bent to", number(1e3 * folds["sharpest_tenth_radius_m"], "mm")],
            ["Sharpest radius of curvature", radius],
            ["… over the thickness", number(folds["sharpest_radius_over_thickness"])],
            ["… from the moulded pole, azimuth", _place(folds["sharpest_place_deg"])],
            ["… at the time", number(folds["sharpest_time_s"], "s")],
        ]
    rows += [
        ["Folded over, most", percent(folds["folded_area_max_fraction"])],
        ["Steps with layers in touch", percent(folds["layers_touch_share_of_steps"])],
    ]
    return Table(head=["Folds", ""], rows=rows, note=_NOTE)


def _place(angles: list[float]) -> str:
    polar, azimuth = (round(angle) % 360 for angle in angles)
    return f"({polar}°, {azimuth}°)"


def _curvature_map(run: RunFiles, folds: dict[str, Any]) -> list[Picture]:
    if folds["number_max"] is None:
        return []
    results = run.results
    sharpness = FoldFinder(results.reference, results.triangles).sharpness(results.position[-1])
    text = (
        "Where it is bent at the end of the run: thickness over the radius of curvature, the "
        "sharper one. The moulded shape unrolled. Ring: the sharpest."
    )
    source = mould_map(results, run.scene.diaphragm.thickness * sharpness, "thickness / radius")
    return [Picture(source=source, caption=text, alt=text)]
