"""Tables of a study that the command line prints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.cli.plain_table import figure, print_table
from coupling.cli.record_tables import print_record_study

_ERRORS = {
    "shape_rms": "shape, rms / R",
    "cg_amplitude": "CG amplitude",
    "cg_phase_deg": "CG phase [deg]",
    "force_amplitude": "force amplitude",
    "pressure_rms": "pressure, rms",
}


def print_study(study: Mapping[str, Any], folder: Path) -> None:
    """Errors of a study with their bars, one row a model; then speed against error."""
    models: Mapping[str, Mapping[str, Any]] = study.get("models") or {}
    names = list(dict.fromkeys(name for row in models.values() for name in row.get("error") or {}))
    heads = [_ERRORS.get(name, name) for name in names]
    rows: list[tuple[str, ...]] = []
    for model, row in models.items():
        cost = figure(row.get("wall_s")), figure(row.get("speedup"), 3)
        rows.append((model, *cost, *_errors(row.get("error") or {}, names)))
        if row.get("against_same_model"):
            name = f".. against {row['model']}"
            rows.append((name, "", "", *_errors(row["against_same_model"], names)))
    if study.get("uncertainty"):
        own = [f"± {figure(study['uncertainty'].get(name), 2)}" for name in names]
        rows.append((f"{study.get('reference')}'s own", "", "", *own))
    title = f"errors against {study.get('reference')}, in {folder}"
    print_table(title, ("model", "wall [s]", "speedup", *heads), rows)
    if study.get("points"):
        _print_points(study["points"], [name for name in names if not name.endswith("_deg")])
    record = study.get("record")
    if record:
        print_record_study(record, str(study.get("reference")))
    verdict = (record or {}).get("verdict") or study.get("verdict")
    for sentence in (verdict, study.get("advice")):
        if sentence:
            print(sentence)


def _errors(errors: Mapping[str, Any], names: Sequence[str]) -> list[str]:
    return [figure(errors.get(name), 3) for name in names]


def _print_points(points: Sequence[Mapping[str, Any]], names: Sequence[str]) -> None:
    rows = [
        (
            f"{point['model']}, {point['resolution'].replace('_', ' ')}",
            figure(point["wall_s"]),
            figure(point.get("cpu_s")),
            *(
                figure(point["error"].get(name), 3) + (" *" if name in point["on_front"] else "")
                for name in names
            ),
        )
        for point in sorted(points, key=lambda item: item["wall_s"] or float("inf"))
    ]
    heads = [_ERRORS.get(name, name) for name in names]
    print_table("speed against error, * on the front", ("run", "wall [s]", "CPU [s]", *heads), rows)
