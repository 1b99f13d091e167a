"""The verb ``edt compare``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from coupling.cli.exit_status import guarded
from coupling.cli.json_output import print_json
from coupling.cli.options import AsJson

if TYPE_CHECKING:
    from coupling import ScanComparison


@guarded("coupling.api.scans", "coupling.scans.comparison", "coupling.report")
def compare(
    scan: Annotated[
        Path, typer.Argument(metavar="SCAN", help="PLY, STL or OBJ, in the tank's frame.")
    ],
    folder: Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.")],
    unit: Annotated[
        str, typer.Option("--unit", metavar="mm|m|in", help="Unit of the scan; no default.")
    ],
    at: Annotated[
        float | None,
        typer.Option(
            "--at",
            metavar="SECONDS",
            help="The written instant nearest to this; if not given the settled one, the first.",
        ),
    ] = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="DIR", help="Where it is written; else to RUN."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Hold a scan of a real diaphragm against a run's, as it is given and aligned.

    The scan may be a point cloud or a surface, noisy, with holes or of a part. Its frame is the
    tank's (origin at the centre, z along the axis) but for a small motion and any rotation about
    the axis. Writes compare.json, compare.csv (a map over the diaphragm's nodes) and compare.html.
    """
    from coupling import compare_scan

    done = compare_scan(scan, folder, unit, at=at, out=output)
    if as_json:
        print_json(done.table)
    else:
        _print(done)


def _print(done: ScanComparison) -> None:
    """Statistics as given and aligned, and the motion; remarks below."""
    from coupling.cli.plain_table import print_table
    from coupling.scans.statistics import COUNTS, NAMES

    table = done.table
    given, aligned = table["as_given"], table["aligned"]
    rows = [
        (f"{name} [mm]", *(_figure(one["figures"].get(key), 1e3) for one in (given, aligned)))
        for key, name in NAMES.items()
    ]
    rows += [
        (name, *(str(one["counts"][key]) for one in (given, aligned)))
        for key, name in COUNTS.items()
    ]
    title = f"{table['scan']} against {table['run']} at {table['instant_s']:g} s"
    print_table(title, ("scan less run", "as given", "aligned"), rows)
    motion = table["alignment"]
    moves = [
        (name, _figure(motion[key], scale))
        for key, (name, scale) in {
            "shift_x_m": ("shift along x [mm]", 1e3),
            "shift_y_m": ("shift along y [mm]", 1e3),
            "shift_z_m": ("shift along the axis [mm]", 1e3),
            "tilt_x_deg": ("tilt about x [deg]", 1.0),
            "tilt_y_deg": ("tilt about y [deg]", 1.0),
            "azimuth_deg": ("rotation about the axis [deg]", 1.0),
            "explained": ("share of the mean square distance that it explains [%]", 100.0),
        }.items()
    ]
    print_table("alignment: what moves the scan onto the run", ("motion", "value"), moves)
    for remark in table["remarks"]:
        print(remark)
    print(
        f"The run's triangles lie {1e3 * table['facet_error_m']:.2g} mm rms off the smooth surface "
        "through their nodes, an error of its grid that no +- holds."
    )
    print("+-: one standard error, by which a figure differs had other points been scanned.")
    print(f"map: {done.folder / 'compare.csv'}")
    print(f"report: {done.folder / 'compare.html'}")


def _figure(found: Any, scale: float) -> str:
    """A figure and its standard error; a word where there is none."""
    from coupling.scans.statistics import written

    return "none" if found is None else " +- ".join(written(found, scale))
