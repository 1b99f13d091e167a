"""A scan against a run's diaphragm at an instant: as it is given and aligned, in one table."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from coupling.ports import Array, Ints
from coupling.scans.alignment import Alignment, align
from coupling.scans.errors import ScanError
from coupling.scans.node_map import node_means
from coupling.scans.pose import AXES, names_known
from coupling.scans.reading import check_size, read_scan
from coupling.scans.sampling_error import blocks_of, mean_error
from coupling.scans.sheet import Sheet
from coupling.scans.statistics import Figure, Measured, explained, measure
from coupling.store.results import Results
from coupling.store.surface import instant_row

_SAID = {
    "shift_x": "a shift along x",
    "shift_y": "a shift along y",
    "shift_z": "a shift along the tank's axis",
    "tilt_x": "a rotation about x",
    "tilt_y": "a rotation about y",
    "azimuth": "the rotation about the tank's axis",
}
_LARGE_SHIFT, _LARGE_TILT = 0.1, np.radians(10.0)  # of the radius, of a motion that is not small
_AT_REST = 0.1  # of the motion's own error: a last motion that is no matter
_ROUNDED = 1e-6  # of the radius, at which the iteration ends
_FEW_INSIDE = 0.5  # of the points: fewer with a counterpart are said


@dataclass(frozen=True, kw_only=True)
class Comparison:
    """A scan held against a run.

    Attributes
    ----------
    table
        What ``compare.json`` holds.
    nodes
        Columns (n,) of ``compare.csv``, NaN where nothing was scanned.
    """

    table: dict[str, Any]
    nodes: dict[str, Array]


def compare_points(scan: Path, unit: str, results: Results, at: float | None = None) -> Comparison:
    """Hold the scan in a file against a run's diaphragm at the written instant nearest to a time.

    ``unit``: that of the scan, see ``UNITS``; ``at`` [s]: None for the first instant, at which the
    run has settled.

    Raises
    ------
    ScanError
        The scan cannot be read, its unit cannot be right, or it lies nowhere near the diaphragm.
    NoInstantError
        The run has no instant then.
    """
    row = instant_row(results, at, first=True)
    points, position = read_scan(scan, unit), results.position[row]
    check_size(points, position, scan, unit)
    sheet = Sheet(position, results.triangles)
    size = float(np.linalg.norm(results.reference, axis=1).max())
    _check_overlap(sheet, points, size, scan)
    blocks = blocks_of(points)
    alignment = align(sheet, points, size)
    before = measure(sheet, points, blocks, size)
    moved = alignment.pose.moved(points)
    after = measure(sheet, moved, blocks, size, alignment.influence)
    return Comparison(
        table={
            "scan": str(scan),
            "unit": unit,
            "scanned_points": len(points),
            "model": results.model,
            "instant_s": float(results.time[row]),
            "facet_error_m": sheet.facet_error(after.matches),
            "as_given": _columns(before),
            "aligned": _columns(after),
            "alignment": _motion(alignment, size, blocks)
            | {"explained": asdict(explained(before, after, blocks, size))},
            "remarks": _remarks(alignment, size, blocks, after),
        },
        nodes=_nodes(sheet, results.reference, before, after),
    )


def _check_overlap(sheet: Sheet, points: Array, size: float, scan: Path) -> None:
    distance = sheet.match(points)
    far = float(np.median(np.abs(distance.distance)))
    if far > size or bool(distance.beyond.all()):
        centre = ", ".join(f"{one:.3g}" for one in points.mean(axis=0))
        raise ScanError(
            f"{scan}: does not lie on the diaphragm: half of its points are {far:.3g} m and more "
            f"away, its middle is at ({centre}) m. Give it in the tank's frame: origin at the "
            "tank's centre, z upward along its axis, at any azimuth."
        )


def _columns(measured: Measured) -> dict[str, Any]:
    return {
        "figures": {name: asdict(figure) for name, figure in measured.figures.items()},
        "counts": measured.counts,
    }


def _motion(alignment: Alignment, size: float, blocks: Ints) -> dict[str, Any]:
    """The motion that takes the scan onto the run, null for what the surface does not determine."""
    pose, known = alignment.pose, names_known(alignment.basis)
    values = [*pose.shift, *np.degrees(pose.tilt), np.degrees(pose.azimuth)]
    scale = np.repeat([1.0, np.degrees(1.0) / size], 3)
    moved: dict[str, Any] = {}
    for name, value, one, each in zip(AXES, values, scale, alignment.influence.T, strict=True):
        key = f"{name}_{'m' if name.startswith('shift') else 'deg'}"
        error = float(one * mean_error(each, blocks))
        found = Figure(value=float(value), standard_error=error)
        moved[key] = asdict(found) if known[name] else None
    return {
        **moved,
        "rotation": pose.rotation.tolist(),
        "shift": pose.shift.tolist(),
        "azimuths_as_good_deg": [float(np.degrees(one)) for one in alignment.as_good],
        "last_motion_m": alignment.left,
    }


def _remarks(alignment: Alignment, size: float, blocks: Ints, after: Measured) -> list[str]:
    """What a reader has to know of the figures."""
    known, pose = names_known(alignment.basis), alignment.pose
    found = []
    unknown = [_SAID[name] for name in AXES if not known[name]]
    if unknown:
        found.append(
            f"The surface does not determine {', '.join(unknown)}: it shows no more of it than its "
            "grid's triangles add, so no figure is given and that is left as scanned."
        )
    if alignment.as_good:
        others = ", ".join(f"{np.degrees(one):.1f}" for one in alignment.as_good)
        found.append(
            f"Rotations by {others} degrees fit as well within the error of the fit; the least one "
            "is taken."
        )
    errors = [mean_error(each, blocks) for each in alignment.influence.T]
    error = float(np.linalg.norm(errors))
    if alignment.left > max(_AT_REST * error, _ROUNDED * size):
        found.append(
            "The alignment did not come to rest: it still moves by "
            f"{1e3 * alignment.left:.2g} mm an iteration, for an error of {1e3 * error:.2g} mm."
        )
    if np.linalg.norm(pose.shift) > _LARGE_SHIFT * size or np.linalg.norm(pose.tilt) > _LARGE_TILT:
        found.append(
            "The motion is not small (a tenth of the radius, 10 degrees of tilt): see whether the "
            "scan is in the tank's frame."
        )
    if after.counts["points"] < _FEW_INSIDE * len(blocks):
        found.append("Most of the scan lies beyond the diaphragm's rim and is left out.")
    return found


def _nodes(sheet: Sheet, reference: Array, before: Measured, after: Measured) -> dict[str, Array]:
    """Columns of the map: the moulded place, the place at the instant, differences."""
    found: dict[str, Array] = {}
    for prefix, places in (("moulded", reference), ("run", sheet.nodes)):
        for axis, values in zip("xyz", places.T, strict=True):
            found[f"{prefix}_{axis}_m"] = values
    for name, measured in (("as_given", before), ("aligned", after)):
        means: Mapping[str, Array] = node_means(sheet, measured)
        found[f"points_{name}"] = means["points"]
        found[f"vertical_{name}_m"] = means["vertical"]
        found[f"normal_{name}_m"] = means["normal"]
    return found
