"""How long a run will take, roughly.

From seconds a step measured on two shared cores; they vary by half from machine to machine.
"""

from __future__ import annotations

from cloth.load import DRY, WET
from coupling.scene import Scene

# Seconds: an inner iteration of a cloth of 24 rings, all of a step's overhead spread over ten;
# a settling's inner iterations; one coupled step on 1300 cells; solves of a step with a potential.
_CLOTH_ITERATION = 6e-4
_SETTLING = 10000
_FLOW_STEP = 0.15
_POTENTIAL_SOLVES = 1.6


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of one step [s] with ``fluid`` in place of the scene's own model.

    The cloth's share grows with its triangles and inner iterations, the flow's with its cells.
    """
    if fluid == "potential":
        solve = _iteration_cost(scene) * (scene.cloth.iterations or WET.iterations)
        return _POTENTIAL_SOLVES * solve
    dry = _iteration_cost(scene) * (scene.cloth.iterations or DRY.iterations)
    return dry + (_FLOW_STEP * scene.openfoam.cells / 1300.0 if fluid == "openfoam" else 0.0)


def _iteration_cost(scene: Scene) -> float:
    return float(_CLOTH_ITERATION * (scene.cloth.rings / 24.0) ** 2.3)


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of the whole run [s], settling (always without a flow) included."""
    return _SETTLING * _iteration_cost(scene) + scene.time.steps * step_cost(scene, fluid)
