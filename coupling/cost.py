"""How long a run will take, roughly.

From seconds a step measured on two shared cores; they vary by half from machine to machine.
"""

from __future__ import annotations

from coupling.scene import Scene

# Seconds a step: cloth of 24 rings and 20 inner iterations; one coupled step on 1300 cells.
_CLOTH_STEP = 0.02
_FLOW_STEP = 0.5


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of one step [s] with ``fluid`` in place of the scene's own model.

    The cloth's share grows with its triangles and inner iterations, the flow's with its cells.
    """
    cloth = scene.cloth
    dry = _CLOTH_STEP * (cloth.resolution / 24.0) ** 2 * cloth.iterations / 20.0
    return dry + (_FLOW_STEP * scene.openfoam.cells / 1300.0 if fluid == "openfoam" else 0.0)


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of the whole run [s], settling (always without a flow) included."""
    settling = scene.time.settle / scene.time.step * step_cost(scene, "hydrostatic")
    return settling + scene.time.steps * step_cost(scene, fluid)
