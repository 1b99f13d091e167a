"""The report of a scan held against a run: statistics, alignment, maps of the difference."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from coupling.ports import Array, Ints
from coupling.report.page import Page, Section, Table, number, percent
from coupling.report.scan_figures import scan_maps
from coupling.scans.statistics import COUNTS, NAMES, written

_MOTION = {
    "shift_x_m": ("Shift along x (mm)", 1e3),
    "shift_y_m": ("Shift along y (mm)", 1e3),
    "shift_z_m": ("Shift along the tank's axis (mm)", 1e3),
    "tilt_x_deg": ("Tilt about x (°)", 1.0),
    "tilt_y_deg": ("Tilt about y (°)", 1.0),
    "azimuth_deg": ("Rotation about the tank's axis (°)", 1.0),
}
_ERRORS = (
    "±: one standard error, by which a figure would differ had other points been scanned, with "
    "other noise of the scanner. Points that are near to each other may err together: blocks of "
    "them are what is taken as independent. An error of the scanner that is the same everywhere "
    "is not in it, nor is what was not scanned."
)


def scan_page(table: Mapping[str, Any], nodes: Mapping[str, Array], triangles: Ints) -> Page:
    """Page of what ``compare.json`` (``table``) and ``compare.csv`` (``nodes``) hold."""
    aligned, motion = table["aligned"]["figures"], table["alignment"]
    mean = aligned["distance_mean_m"]
    share = motion["explained"]
    return Page(
        title=f"{Path(table['scan']).name} against {Path(table['run']).resolve().name}",
        subtitle=f"{table['scanned_points']:,} points in {table['unit']} · {table['model']} · "
        f"t = {number(table['instant_s'], 's')}",
        verdict=f"Aligned, the scan lies {_with_error(mean, 1e3)} mm off the run's diaphragm in "
        "the mean.",
        explanation=f"As given it lies {_with_error(_given(table), 1e3)} mm off. Alignment "
        f"explains {percent(share['value'])} of the mean square distance.",
        alarm=" ".join(table["remarks"]),
        sections=[
            Section(title="Statistics", tables=[_statistics(table), _counts(table)]),
            Section(title="Alignment", tables=[_alignment(motion)]),
            Section(title="Where it differs", pictures=scan_maps(nodes, triangles)),
            Section(title="What is meant", tables=[_meaning(table)]),
        ],
        footer="Figures: compare.json; the map, one row a node of the diaphragm: compare.csv.",
    )


def _given(table: Mapping[str, Any]) -> Mapping[str, float]:
    found: Mapping[str, float] = table["as_given"]["figures"]["distance_mean_m"]
    return found


def _with_error(figure: Mapping[str, float] | None, scale: float) -> str:
    if figure is None:
        return "–"
    return " ± ".join(written(figure, scale)).replace("-", "−")


def _statistics(table: Mapping[str, Any]) -> Table:
    rows = [
        [
            f"{name[0].upper()}{name[1:]} (mm)",
            *(_with_error(table[one]["figures"].get(key), 1e3) for one in ("as_given", "aligned")),
        ]
        for key, name in NAMES.items()
    ]
    return Table(head=["Scan less run", "as given", "aligned"], rows=rows, note=_ERRORS)


def _counts(table: Mapping[str, Any]) -> Table:
    rows = [
        [
            f"{name[0].upper()}{name[1:]}",
            *(f"{table[one]['counts'][key]:,}" for one in ("as_given", "aligned")),
        ]
        for key, name in COUNTS.items()
    ]
    return Table(head=["", "as given", "aligned"], rows=rows)


def _alignment(motion: Mapping[str, Any]) -> Table:
    rows = [
        [name, "not determined" if motion[key] is None else _with_error(motion[key], scale)]
        for key, (name, scale) in _MOTION.items()
    ]
    rows.append(["Explained of the mean square (%)", _with_error(motion["explained"], 100.0)])
    note = (
        "What moves the scan onto the run: first the rotation about the tank's axis, then the tilt "
        "and the shift, about the tank's centre. It was looked for from azimuths all "
        "around, where the surface determines one."
    )
    return Table(head=["Motion", ""], rows=rows, note=note)


def _meaning(table: Mapping[str, Any]) -> Table:
    rows = [
        [
            "Vertical difference",
            "How far a point lies above the run's diaphragm along the tank's axis; of several "
            "layers the one nearest in height. Where the run's is steeper than 75° there is none: "
            "towards a wall it would grow without limit.",
        ],
        [
            "Nearest distance",
            "From a point to the nearest place on the run's triangles. Points whose nearest place "
            "is on the rim have no counterpart and are left out.",
        ],
        [
            "The run's grid",
            f"Its triangles lie {number(1e3 * table['facet_error_m'], 'mm', 2)} rms off the smooth "
            "surface through their nodes (the sagitta of each). A scan of the real diaphragm is "
            "off by that much, too, and no ± holds it.",
        ],
        [
            "Noise",
            "The nearest distance of a perfect scan with normal noise of standard deviation s has "
            "the mean 0.8 s and the rms s.",
        ],
        [
            "Largest and least",
            f"Of as many points, {table['scanned_points']:,}: with more points the one grows and "
            "the other falls.",
        ],
    ]
    return Table(rows=rows, numbers=False)
