"""What is kept of a sweep: one row a point, as JSON and as a table for spreadsheets."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.campaign.sweep_plan import Plan, Point
from coupling.campaign.wanted import figure_at
from coupling.estimate.numbers import numbers_of
from coupling.fluids import FLUIDS
from coupling.metrics.comparison import NAMES, compare
from coupling.ports import RunFailed
from coupling.store.results import read_results

_OF_A_MODEL = ("status", "wall_s", "failure")


def row_of(
    point: Point,
    folder: Path,
    summaries: Mapping[str, Mapping[str, Any]],
    wanted: Sequence[str] = (),
) -> dict[str, Any]:
    """The row of a point whose models have all run, into ``folder/<model>``, or failed.

    Errors are those of a study, against the highest model that completed here; a sweep of one model
    has none. ``failure`` is None where all of them did. ``wanted``: dotted names of the figures of
    each summary that go into the row as they are.
    """
    models = list(summaries)
    best = _highest(name for name in models if summaries[name].get("status") == "completed")
    if len(models) < 2:
        best = None
    scene = point.scenes[models[0]]
    rows = {name: _model_row(summaries[name], wanted) for name in models}
    for name, row in rows.items():
        try:
            if best is not None and row["failure"] is None:
                row["error"] = compare(
                    read_results(folder / name), summaries[name],
                    read_results(folder / best), summaries[best], scene.tank.shell.size,
                )  # fmt: skip
        except RunFailed as error:
            row["status"], row["failure"] = "failed", str(error)
    failures = [f"{name}: {row['failure']}" for name, row in rows.items() if row["failure"]]
    return {
        "point": point.name,
        "values": point.values,
        "numbers": numbers_of(scene).to_dict(),
        "reference": best,
        "models": rows,
        "failure": "; ".join(failures) or None,
    }


def _highest(models: Iterable[str]) -> str | None:
    return max(models, key=FLUIDS.rank, default=None)


def _model_row(summary: Mapping[str, Any], wanted: Sequence[str]) -> dict[str, Any]:
    failed = summary.get("status") != "completed"
    return {
        "wanted": {name: None if failed else figure_at(summary, name) for name in wanted},
        "status": summary.get("status"),
        "failure": (summary.get("error") or "no reason was given") if failed else None,
        "wall_s": summary.get("wall_s"),
        "error": {},
        "cg": summary.get("cg"),
        "force": summary.get("force"),
        "bernoulli": summary.get("bernoulli"),
        "rubs": summary.get("rubs"),
        "fitted_periods": summary.get("fitted_periods"),
    }


def sweep_json(plan: Plan, title: str, rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """What ``sweep.json`` holds; ``rows`` of the points that are done, in the grid's order."""
    return {
        "title": title,
        "axes": [
            {"key": axis.key, "values": list(axis.values), "logarithmic": axis.logarithmic}
            for axis in plan.axes
        ],
        "models": list(plan.models),
        "reference": _highest(plan.models) if len(plan.models) > 1 else None,
        "wanted": list(plan.wanted),
        "points": len(plan.points),
        "rows": list(rows),
    }


def sweep_csv(content: Mapping[str, Any]) -> str:
    """The rows of ``sweep_json`` as comma-separated values, one column a figure.

    With figures that were wanted one line a run, which has these alone; else one a point.
    """
    if content.get("wanted"):
        return table_csv([line for row in content["rows"] for line in tidy(row)])
    return table_csv([_flat(row) for row in content["rows"]])


def tidy(row: Mapping[str, Any]) -> list[dict[str, Any]]:
    """One line a run of a point's ``row``: keys, model, status, wanted figures, failure."""
    return [
        {
            **row["values"],
            "model": model,
            "status": figures["status"],
            **figures["wanted"],
            "failure": figures["failure"],
        }
        for model, figures in row["models"].items()
    ]


def table_csv(lines: Sequence[Mapping[str, Any]]) -> str:
    """Return ``lines`` by column as comma-separated values below their heads."""
    heads = list(dict.fromkeys(name for line in lines for name in line))
    text = io.StringIO()
    writer = csv.DictWriter(text, heads, lineterminator="\n")
    writer.writeheader()
    writer.writerows(lines)
    return text.getvalue()


def _flat(row: Mapping[str, Any]) -> dict[str, Any]:
    line: dict[str, Any] = {"point": row["point"], **row["values"], **row["numbers"]}
    line["reference"] = row["reference"]
    for model, figures in row["models"].items():
        line |= {f"{model}.{name}": figures[name] for name in _OF_A_MODEL}
        line |= {f"{model}.error.{name}": figures["error"].get(name) for name in NAMES}
        moved = (figures["cg"] or {}).get("amplitude_m") or [None] * 3
        line |= {f"{model}.cg_{axis}_m": value for axis, value in zip("xyz", moved, strict=True)}
        line |= {f"{model}.{name}": value for name, value in (figures["bernoulli"] or {}).items()}
        line |= {f"{model}.{name}": value for name, value in _rubs(figures.get("rubs")).items()}
    return line


def _rubs(rubs: Mapping[str, Any] | None) -> dict[str, Any]:
    """The figures of a summary's ``rubs`` one by one, those of a pair by what they are."""
    flat: dict[str, Any] = {}
    for name, value in (rubs or {}).items():
        angles = name.endswith("_deg")
        pair = ("polar", "azimuth") if angles else ("least", "largest")
        if angles or name.endswith("wear_max_m"):
            both = value or (None, None)
            flat |= {f"{name}.{part}": one for part, one in zip(pair, both, strict=True)}
        else:
            flat[name] = value
    return flat
