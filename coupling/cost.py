"""How long a run will take, roughly: to a factor of two, on a core that is free.

All constants are CPU seconds of one core, fitted to the runs that ``test_cost`` holds the estimates
against. A flow is taken to have the solver that stays alive and the scheme ``added-mass``. Half of
its step or more is then the added mass, made once: whether it takes two iterations or four changes
the step by a quarter, and how many it will be is not asked.
"""

from __future__ import annotations

from cloth.load import DRY, WET
from coupling.foam.mesh import cells_made
from coupling.scene import Scene

_CLOTH_ITERATION = 6e-4  # an inner iteration of 24 rings, a step's overhead spread over ten
_SETTLING = 8000  # inner iterations of a settling
_POTENTIAL = 30  # what a potential adds to a step, in inner iterations
_COUPLED_SOLVES = 3.0  # of the cloth in a coupled step
_COUPLED_ROWS = 120  # what the rows of a flow's added mass add to it, in inner iterations
_CELLS = 1216  # that the next two are for
_ADDED_MASS, _GROWTH = 0.05, 1.6  # by a sparse factor; its growth with the cells
_FLOW_SOLVES = 0.045  # in a step


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of one step [s] with ``fluid`` in place of the scene's own model.

    The cloth's share grows with its triangles and inner iterations, the flow's with its cells.
    """
    inner = _iteration_cost(scene)
    stated = scene.cloth.iterations
    if fluid == "potential":
        return inner * ((stated or WET.iterations) + _POTENTIAL)
    if fluid != "openfoam":
        return inner * (stated or DRY.iterations)
    cloth = inner * (_COUPLED_SOLVES * (stated or WET.iterations) + _COUPLED_ROWS)
    size = cells_made(scene.openfoam.cells) / _CELLS
    return float(cloth + _ADDED_MASS * size**_GROWTH + _FLOW_SOLVES * size)


def _iteration_cost(scene: Scene) -> float:
    return float(_CLOTH_ITERATION * (scene.cloth.rings / 24.0) ** 2.3)


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated wall time of the whole run [s], settling (always without a flow) included."""
    return _SETTLING * _iteration_cost(scene) + scene.time.steps * step_cost(scene, fluid)
