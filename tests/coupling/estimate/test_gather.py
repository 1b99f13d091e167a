"""The data behind `auto`: rows that are gathered from sweeps, by a hand-made one."""

import csv
import io
import json

import pytest

from coupling.fluids.openfoam.model import grid_error
from foam_cases.sway_map.gather import grid_rows, main, model_rows

STILL = [0.0, 0.0]


def model(x, *, phase=0.0, status="completed", fitted=1):
    """A run whose CG swings along x by ``x`` [m] at ``phase`` [degrees]."""
    cg = {"amplitude_m": [x, *STILL], "phase_deg": [phase, None, None]}
    return {"status": status, "cg": cg, "fitted_periods": fitted}


def point(models, **values):
    numbers = {"frequency_ratio": 1.1379392, "acceleration_ratio": 0.1, "fill_fraction": 0.8}
    return {"values": {"motion.frequency": 1.25, **values}, "numbers": numbers, "models": models}


def test_every_model_stands_against_the_next_one_up_that_completed():
    models = {
        "hydrostatic": model(0.03),
        "potential": model(0.02),
        "openfoam": model(0.02, phase=90.0),
    }
    rows = list(model_rows(point(models)))
    assert [(row["model"], row["reference"]) for row in rows] == [
        ("hydrostatic", "potential"),
        ("potential", "openfoam"),
    ]
    # |3 - 2|/2, and |1 - i| = sqrt(2); four digits are kept
    assert [row["error"] for row in rows] == ["0.5", "1.414"]
    assert rows[0]["frequency_ratio"] == "1.1379"
    skipped = models | {"potential": model(0.02, status="failed")}
    assert [row["reference"] for row in model_rows(point(skipped))] == ["openfoam"]


def test_a_motion_that_is_not_fitted_or_does_not_move_gives_no_row():
    assert not list(model_rows(point({"hydrostatic": model(1.0), "potential": model(0.0)})))
    unfitted = {"hydrostatic": model(1.0, fitted=0), "potential": model(1.0)}
    assert not list(model_rows(point(unfitted)))


def grid(coarse, fine):
    """Two points that differ in their cells alone."""
    return [
        point({"openfoam": coarse}, **{"openfoam.cells": 650}),
        point({"openfoam": fine}, **{"openfoam.cells": 1300}),
    ]


def test_the_grids_own_error_is_richardsons():
    (row,) = grid_rows(grid(model(0.03), model(0.02)))
    # 540 cells are (1216/540)^(1/3) times as wide as 1216, the error is of order 1.5 in the width:
    # 0.5/(sqrt(1216/540) - 1)
    assert grid_error(0.5) == pytest.approx(0.5 / ((1216 / 540) ** 0.5 - 1.0))
    assert (row["model"], row["reference"], row["error"]) == ("openfoam", "openfoam", "0.9988")


def test_a_grid_whose_other_half_failed_gives_no_row():
    assert not list(grid_rows(grid(model(0.03, status="failed"), model(0.02))))
    assert not list(grid_rows(grid(model(0.03), model(0.02))[1:]))


def test_a_later_sweep_replaces_the_same_place(tmp_path, capsys):
    first = point({"hydrostatic": model(0.03), "potential": model(0.02)})
    later = point({"hydrostatic": model(0.025), "potential": model(0.02)})
    other = first | {"numbers": first["numbers"] | {"fill_fraction": 0.5}}
    for name, rows in (("first", [first, other]), ("later", [later])):
        (tmp_path / name).mkdir()
        (tmp_path / name / "sweep.json").write_text(json.dumps({"rows": rows}))
    main([str(tmp_path / "first"), str(tmp_path / "later")])
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [(row["fill_fraction"], row["error"]) for row in rows] == [
        ("0.8", "0.25"),
        ("0.5", "0.5"),
    ]


def test_coarse_grids_are_no_rows_of_their_own(tmp_path, capsys):
    coarse, fine = grid(model(0.03), model(0.02))
    for one in (coarse, fine):
        one["models"]["potential"] = model(0.021)
    (tmp_path / "sweep.json").write_text(json.dumps({"rows": [coarse, fine]}))
    main([str(tmp_path)])
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    assert [(row["model"], row["error"]) for row in rows] == [
        ("potential", "0.05"),
        ("openfoam", "0.9988"),
    ]
