"""What the command line prints of runs and studies by a record."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from coupling.cli.plain_table import figure, print_table

_NAMES = {"cg": "CG", "force": "force", "moment": "moment"}
_HEADS = {"acceleration": "tank [m/s^2]", "cg": "CG [m]", "force": "force [N]"}


def record_rows(record: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Rms and peak of CG, force and moment by component, both about the mean."""
    rows: list[tuple[str, Any]] = []
    for name, text in _NAMES.items():
        found = record["signals"][name]
        rows += [
            (f"{text}, rms [{found['unit']}]", figure(list(found["rms"]))),
            (f"... peak [{found['unit']}]", figure(list(found["peak"]))),
        ]
    return rows


def print_bands(record: Mapping[str, Any]) -> None:
    """Rms in every octave, over all three axes; nothing of a run too short for a spectrum."""
    if not record["bands"]:
        return
    rows = [
        (
            _band(row),
            *(figure(math.sqrt(sum(x * x for x in row["rms"][name])), 3) for name in _HEADS),
            f"{100.0 * row['random_error']:.2g} %",
        )
        for row in record["bands"]
    ]
    heads = ("band [Hz]", *_HEADS.values(), "scatter")
    print_table("rms by band of frequency, over all axes", heads, rows)


def print_record_study(record: Mapping[str, Any], reference: str) -> None:
    """Every model's error in CG and force by band, with the reference's own."""
    if not record["bands"]:
        return
    signals, models = ("cg", "force"), list(record["error"])
    rows = []
    for row in record["bands"]:
        name = f"{row['from_hz']:g} to {row['to_hz']:g} Hz"
        cells = [
            figure(record["error"][model][signal].get(name), 3)
            for model in models
            for signal in signals
        ]
        own = [figure(record["uncertainty"][signal].get(name), 2) for signal in signals]
        rows.append((_band(row), f"{100.0 * row['cg_share']:.2g} %", *cells, *own))
    heads = [f"{model}, {_NAMES[signal]}" for model in models for signal in signals]
    heads += [f"{reference}'s own, {_NAMES[signal]}" for signal in signals]
    title = "errors by band of frequency: rms of the difference over rms of the reference"
    print_table(title, ("band [Hz]", "of the CG's power", *heads), rows)


def _band(row: Mapping[str, float]) -> str:
    return f"{row['from_hz']:g} to {row['to_hz']:.4g}"
