"""Gathers what sweeps found into the data that `edt check` and `model.fluid = "auto"` rest on.

    python foam_cases/sway_map/gather.py SWEEP [SWEEP ...] > coupling/estimate/model_errors.csv

SWEEP is a folder that `edt sweep` wrote. A model of a point is a row, against the next one up that
completed there. A sweep over ``openfoam.cells`` of N/2 and N also gives the grid's own error on N,
by Richardson's estimate, as a study has it (``coupling/metrics/uncertainty.py``). A row of a later
sweep replaces that of an earlier one at the same frequency, acceleration and fill.
"""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from coupling.estimate.model_errors import COLUMNS, ladder
from coupling.fluids.openfoam.model import CELLS, FEWER, grid_error
from coupling.metrics.comparison import cg_motion


def model_rows(point: Mapping[str, Any]) -> Iterator[dict[str, Any]]:
    """Rows of one point: every model that completed against the next one up that did."""
    models = point["models"]
    done = [name for name in ladder() if (models.get(name) or {}).get("status") == "completed"]
    for model, reference in pairwise(done):
        error = cg_motion(models[model]["cg"], models[reference]["cg"])
        if error is not None and models[model]["fitted_periods"]:
            yield _row(point, model, reference, error)


def grid_rows(points: Sequence[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    """Rows of ``openfoam`` on its grid, from points that differ in ``openfoam.cells`` alone."""
    coarse = {_place(point): point for point in points if _cells(point) == FEWER}
    for point in points:
        other = coarse.get(_place(point))
        if _cells(point) != CELLS or other is None:
            continue
        pair = [one["models"]["openfoam"] for one in (other, point)]
        if all(one["status"] == "completed" for one in pair):
            error = cg_motion(pair[0]["cg"], pair[1]["cg"])
            if error is not None:
                yield _row(point, "openfoam", "openfoam", grid_error(error))


def _cells(point: Mapping[str, Any]) -> int | None:
    return point["values"].get("openfoam.cells")


def _place(point: Mapping[str, Any]) -> tuple[tuple[str, Any], ...]:
    return tuple(item for item in point["values"].items() if item[0] != "openfoam.cells")


def _row(point: Mapping[str, Any], model: str, reference: str, error: float) -> dict[str, Any]:
    numbers = point["numbers"]
    return {
        "model": model,
        "reference": reference,
        "frequency_ratio": f"{numbers['frequency_ratio']:.5g}",
        "acceleration_ratio": f"{numbers['acceleration_ratio']:.5g}",
        "fill_fraction": f"{numbers['fill_fraction']:.5g}",
        "error": f"{error:.4g}",
    }


def main(folders: Sequence[str]) -> None:
    """Print the data of the sweeps in ``folders``."""
    found = {}
    for folder in folders:
        points = json.loads((Path(folder) / "sweep.json").read_text(encoding="utf-8"))["rows"]
        fine = [point for point in points if _cells(point) in (None, CELLS)]
        for row in (*(row for point in fine for row in model_rows(point)), *grid_rows(points)):
            found[tuple(row[name] for name in COLUMNS[:-1])] = row
    writer = csv.DictWriter(sys.stdout, COLUMNS, lineterminator="\n")
    writer.writeheader()
    writer.writerows(found.values())


if __name__ == "__main__":
    main(sys.argv[1:])
