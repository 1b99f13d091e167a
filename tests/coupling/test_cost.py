"""Estimated against measured times: CPU seconds of one core, of runs with one thread."""

from __future__ import annotations

from pathlib import Path

import pytest

from coupling.cost import run_cost, step_cost
from coupling.scene import load_scene

CASES = Path(__file__).parents[2] / "foam_cases"
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
    case: str, changes: str, settling: float, step: float
) -> None:
    scene = load_scene(CASES / case, changes.split())
    one = step_cost(scene, scene.model.fluid)
    before = run_cost(scene, scene.model.fluid) - scene.time.steps * one
    assert 0.5 < 1e3 * one / step < 2.0
    assert 0.5 < before / settling < 2.0
