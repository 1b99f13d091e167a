"""Errors of runs against runs: known differences are found, unknown ones are not invented."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import known_run as run
import numpy as np
import pytest

from coupling.metrics.advice import advice
from coupling.metrics.comparison import NAMES, below, common_instants, compare
from coupling.metrics.summary import summarise
from coupling.results import Results, read_results


def summary_of(results: Results) -> dict[str, Any]:
    return summarise(results, run.statistics(), run.scene(), "completed", None)


def test_a_run_has_no_error_against_itself(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    results = read_results(tmp_path)
    summary = summary_of(results)
    errors = compare(results, summary, results, summary, run.RADIUS)
    assert errors == dict.fromkeys(NAMES, 0.0)


def test_known_differences_are_found(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    best = read_results(tmp_path)
    other = replace(
        best,
        position=best.position + np.array([0.003, 0.0, 0.004]),
        pressure=1.1 * best.pressure,
        liquid_cg=-1.5 * best.liquid_cg,
        force=0.8 * best.force,
    )
    errors = compare(other, summary_of(other), best, summary_of(best), run.RADIUS)
    assert errors == pytest.approx(
        {
            "shape_rms": 0.005 / run.RADIUS,
            "cg_amplitude": 0.5,
            "cg_phase_deg": 180.0,
            "force_amplitude": 0.2,
            "pressure_rms": 0.1,
        }
    )


def test_other_meshes_and_short_runs_are_not_compared_where_they_cannot_be(tmp_path: Path) -> None:
    run.write_run(tmp_path)
    best = read_results(tmp_path)
    other = replace(best, triangles=best.triangles[:-1])
    errors = compare(other, summary_of(best), best, summary_of(best), run.RADIUS)
    assert errors["shape_rms"] is None
    assert errors["pressure_rms"] is None
    assert errors["cg_amplitude"] == 0.0


def test_common_instants_are_found_by_time() -> None:
    fine, coarse = 0.005 * np.arange(41), 0.02 * np.arange(1, 12)
    rows, others = common_instants(fine, coarse)
    assert np.allclose(fine[rows], coarse[others], rtol=1e-12)
    assert len(rows) == 10
    assert len(common_instants(fine + 0.0021, coarse)[0]) == 0
    assert len(common_instants(fine, coarse[:0])[0]) == 0
    assert len(common_instants(fine[:1], fine[:1])[0]) == 1


def test_an_error_below_the_reference_s_own_is_said_to_be() -> None:
    own = {"coarser_grid": {"a": 0.02, "b": None}, "doubled_step": {"a": 0.01, "b": 0.001}}
    assert below({"a": 0.015, "b": 0.5, "c": 0.0}, own) == ["a"]
    assert below({"a": 0.0}, {}) == []


def row(wall: float, error: float | None, speedup: float = 1.0) -> dict[str, Any]:
    errors = {} if error is None else {"shape_rms": error / 2, "cg_amplitude": error}
    return {"wall_s": wall, "speedup": speedup, "error": errors}


def test_the_fastest_model_that_is_good_enough_is_advised() -> None:
    rows = {"datum": row(1, 0.4), "hydrostatic": row(2, 0.03, 50.0), "openfoam": row(100, 0.0)}
    said = advice("openfoam", rows)
    assert said.startswith("Use hydrostatic: it stays within 3.0\u202f% of openfoam")
    assert "50 times as fast" in said
    rows["hydrostatic"] = row(2, 0.3)
    assert advice("openfoam", rows).startswith("Use openfoam. The best of the others, hyd")


def test_advice_does_not_pretend() -> None:
    assert "No model completed" in advice(None, {})
    assert "not completed" in advice("openfoam", {"openfoam": row(1, None)})
    assert "nothing to compare" in advice("openfoam", {"openfoam": row(1, 0.0)})
