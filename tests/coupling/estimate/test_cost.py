"""Estimated against measured times: CPU seconds of one core, of runs with one thread."""

from __future__ import annotations

from pathlib import Path
from time import process_time

import pytest

from coupling.estimate.cost import run_cost, run_time, slowness, step_cost
from coupling.scene.scene import load_scene
from coupling.simulation.driver import run

CASES = Path(__file__).parents[3] / "foam_cases"
# Case, changes, seconds of settling, milliseconds a step: the mean over the run, or over the time
# that stands with it.
MEASURED = [
    ("pad_sway_coarse", "model.fluid=hydrostatic", 1.74, 8.4),
    ("pad_sway_coarse", "model.fluid=hydrostatic cloth.resolution=24", 3.37, 19.1),  # 0.4 s
    ("sway_map", "model.fluid=hydrostatic", 1.35, 6.5),
    ("pad_sway_coarse", "model.fluid=potential", 1.78, 15.8),
    ("pad_sway_coarse", "model.fluid=potential cloth.resolution=24", 3.68, 31.6),  # 0.4 s
    ("pad_sway", "model.fluid=potential", 1.80, 19.4),  # 1.6 s
    ("sway_map", "model.fluid=potential", 1.39, 11.5),
    ("slosh", "model.fluid=potential", 0.76, 8.1),
    ("pad_sway_coarse", "", 1.87, 186.0),  # 3.7 iterations a step
    ("pad_sway_coarse", "cloth.resolution=24", 3.40, 233.0),  # 0.2 s
    ("pad_sway_coarse", "openfoam.cells=5000", 1.82, 569.0),  # 0.2 s
    ("pad_sway_coarse", "openfoam.cells=9728", 1.78, 2281.0),  # 0.1 s
    ("pad_sway", "", 1.86, 155.0),  # 0.3 s
    ("sway_map", "model.fluid=openfoam", 1.42, 115.0),  # 0.6 s
    ("slosh", "", 0.79, 107.0),  # 0.3 s
]


@pytest.mark.parametrize(("case", "changes", "settling", "step"), MEASURED)
def test_costs_are_right_to_a_factor_of_two(
    monkeypatch: pytest.MonkeyPatch, case: str, changes: str, settling: float, step: float
) -> None:
    # As it was when measured.
    monkeypatch.setattr("coupling.foam.solver_cache.built_for_any", lambda: True)
    scene = load_scene(CASES / case, changes.split())
    one = step_cost(scene, scene.model.fluid)
    before = run_cost(scene, scene.model.fluid) - scene.time.steps * one
    assert 0.5 < 1e3 * one / step < 2.0
    assert 0.5 < before / settling < 2.0


def test_a_run_here_takes_a_time_within_the_range_said(tmp_path: Path) -> None:
    """CPU time, as others compute beside the tests; the first run compiles."""
    scene = load_scene(CASES / "pad_sway_coarse", ["model.fluid=hydrostatic", "time.duration=0.2"])
    run(
        load_scene(
            CASES / "pad_sway_coarse",
            ["cloth.resolution=6", "time.duration=0.02", "model.fluid=hydrostatic"],
        ),
        tmp_path / "first",
    )
    slowness.cache_clear()
    low, high = run_time(scene, "hydrostatic")
    start = process_time()
    run(scene, tmp_path / "run")
    assert low < process_time() - start < high


def test_slower_schemes_and_restarts_cost_more(monkeypatch: pytest.MonkeyPatch) -> None:
    """Ratios of wall times in tables of schemes: 2.1 to 3.3 and 5.8 to 10.2; restarts at 1,216
    cells cost 6.4 times an iteration of the flow."""
    monkeypatch.setattr("coupling.foam.solver_cache.built_for_any", lambda: True)
    case = CASES / "pad_sway_coarse"
    cost = {
        text: step_cost(load_scene(case, text.split()), "openfoam")
        for text in (
            "", "coupling.scheme=iqn-ils", "coupling.scheme=aitken", "openfoam.keep_alive=false",
        )
    }  # fmt: skip
    known = cost[""]
    assert 1.5 < cost["coupling.scheme=iqn-ils"] / known < 3.5
    assert 4.5 < cost["coupling.scheme=aitken"] / known < 10.0
    # Restarted all the same.
    monkeypatch.setattr("coupling.foam.solver_cache.built_for_any", lambda: False)
    assert step_cost(load_scene(case), "openfoam") == cost["openfoam.keep_alive=false"]
    assert cost["openfoam.keep_alive=false"] - known == pytest.approx(3 * 0.015 * 5.4, rel=0.3)
