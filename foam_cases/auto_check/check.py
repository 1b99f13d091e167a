"""Holds the choice of `model.fluid = "auto"` against what every rung does, on scenes of its own.

    python foam_cases/auto_check/check.py [-o runs/auto_check]

Each scene of scenes.csv is run on every rung of the ladder, and on `openfoam` with half the cells
too, which gives its own error. Complete runs are kept, so a stopped check goes on. Writes
results.csv beside this file after every scene, and prints the counts.
"""

from __future__ import annotations

import argparse
import csv
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from coupling.campaign.study import run_or_reuse
from coupling.estimate.model_errors import choose, ladder
from coupling.estimate.numbers import numbers_of
from coupling.fluids.openfoam.model import FEWER, grid_error
from coupling.metrics.comparison import cg_motion
from coupling.scene.scene import Scene, load_scene, with_overrides

HERE = Path(__file__).parent
BASE = HERE.parent / "sway_map" / "scene.toml"
COMMON = ("time.periods=4", "time.steps_per_period=50")
LADDER = ladder()
TOP = LADDER[-1]


def scenes() -> dict[str, Scene]:
    """The scenes of scenes.csv by name; its other heads are keys of a scene."""
    with (HERE / "scenes.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    return {
        row.pop("name"): load_scene(
            BASE, [*COMMON, "model.fluid=auto", *(f"{key}={value}" for key, value in row.items())]
        )
        for row in rows
    }


def check(name: str, scene: Scene, folder: Path) -> dict[str, Any]:
    """The row of one scene: what was expected, what was taken, and what every rung errs."""
    numbers, choice, tolerance = numbers_of(scene), choose(scene), scene.model.tolerance
    runs = {model: _run(scene, folder / model, [f"model.fluid={model}"]) for model in LADDER}
    coarse = [f"model.fluid={TOP}", f"openfoam.cells={FEWER}"]
    runs["half"] = _run(scene, folder / "half", coarse)
    errors = true_errors(runs)
    row: dict[str, Any] = {
        "name": name,
        "frequency_ratio": numbers.frequency_ratio,
        "acceleration_ratio": numbers.acceleration_ratio,
        "fill_fraction": numbers.fill_fraction,
        "tolerance": tolerance,
    }
    for model, one in choice.estimates.items():
        row |= {f"{model}.expected": one.expected, f"{model}.upper": one.upper}
    row |= {f"{model}.error": errors[model] for model in LADDER}
    row |= {f"{one}.wall_s": runs[one].get("wall_s") for one in runs}
    return (
        row
        | verdict(choice.fluid, errors, tolerance)
        | {"failure": "; ".join(f"{k}: {v['error']}" for k, v in runs.items() if v.get("error"))}
    )


def true_errors(runs: Mapping[str, Mapping[str, Any]]) -> dict[str, float | None]:
    """Error of every rung against the highest, and of that one on its grid; None: not known."""
    pairs = {model: (model, TOP) for model in LADDER[:-1]} | {TOP: ("half", TOP)}
    errors: dict[str, float | None] = {}
    for model, (one, other) in pairs.items():
        known = all(runs[name].get("status") == "completed" for name in (one, other))
        errors[model] = cg_motion(runs[one]["cg"], runs[other]["cg"]) if known else None
    own = errors[TOP]
    return errors | {TOP: None if own is None else grid_error(own)}


def verdict(
    pick: str, errors: Mapping[str, float | None], tolerance: float
) -> dict[str, str | bool]:
    """Whether the ``pick`` keeps the tolerance, whether a cheaper rung does, and is taken.

    An error that is not known counts as too large.
    """
    keeps = {model for model, error in errors.items() if error is not None and error <= tolerance}
    suffices = bool(keeps - {TOP})
    return {
        "pick": pick,
        "cheapest": next((model for model in LADDER if model in keeps), "none"),
        "keeps": pick in keeps,
        "cheaper_suffices": suffices,
        "cheaper_picked": pick in keeps - {TOP},
    }


def _run(scene: Scene, folder: Path, changes: Sequence[str]) -> dict[str, Any]:
    return run_or_reuse(with_overrides(scene, changes), folder, None)


def _rounded(value: Any) -> Any:
    return f"{value:.4g}" if isinstance(value, float) else value


def main() -> None:
    """Run what is not there yet, and write the table."""
    parser = argparse.ArgumentParser()
    parser.add_argument("-o", type=Path, default=Path("runs/auto_check"))
    folder = parser.parse_args().o
    rows: list[dict[str, Any]] = []
    for name, scene in scenes().items():
        rows.append(check(name, scene, folder / name))
        with (HERE / "results.csv").open("w", encoding="utf-8", newline="") as file:
            writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
            writer.writeheader()
            writer.writerows({key: _rounded(one) for key, one in row.items()} for row in rows)
        print(name, rows[-1]["pick"], "keeps" if rows[-1]["keeps"] else "breaks", "its tolerance")
    could = [row for row in rows if row["cheaper_suffices"]]
    print(f"tolerance kept in {sum(row['keeps'] for row in rows)} of {len(rows)} scenes")
    print(f"cheaper rung taken in {sum(r['cheaper_picked'] for r in could)} of {len(could)} scenes")


if __name__ == "__main__":
    main()
