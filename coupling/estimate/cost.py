"""How long a run will take, roughly: to a factor of two, on a core that is free.

All constants are CPU seconds of one core of the machine of the runs that ``test_cost`` holds the
estimates against; ``slowness`` says how this machine compares. What a
liquid adds to a step its fluid model says.
"""

from __future__ import annotations

from functools import lru_cache
from time import process_time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene

_CLOTH_ITERATION = 6e-4  # an inner iteration of 24 rings, a step's overhead spread over ten
_SETTLING = 11000  # inner iterations of a settling
FACTOR = 2.0  # that an estimate may be off, either way
_REFERENCE = 0.036  # [s] of ``_kernel`` on the machine of the constants above


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated time of one step [s] with ``fluid`` in place of the scene's own model.

    The cloth's share grows with its triangles and inner iterations, the flow's with its cells.
    """
    return FLUIDS[fluid].step_cost(scene, _iteration_cost(scene))


def _iteration_cost(scene: Scene) -> float:
    return float(_CLOTH_ITERATION * (scene.cloth.rings / 24.0) ** 2.3)


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated time of the whole run [s], settling (always without a flow) included."""
    return _SETTLING * _iteration_cost(scene) + scene.time.steps * step_cost(scene, fluid)


def run_time(scene: Scene, fluid: str) -> tuple[float, float]:
    """Shortest and longest wall time [s] to expect of ``run_cost`` on a free core of this machine.

    Takes a tenth of a second to see how fast the machine is just now.
    """
    likely = slowness() * run_cost(scene, fluid)
    return likely / FACTOR, likely * FACTOR


@lru_cache(maxsize=1)
def slowness() -> float:
    """CPU time of this machine over that of the constants' one, for the same work.

    The work is sparse elimination, as the diaphragm's and the liquid's steps are; the least of
    three times counts, which other programs disturb least.
    """
    return min(_kernel() for _ in range(3)) / _REFERENCE


def _kernel() -> float:
    """CPU time [s] of factoring and solving with a matrix of 3600 rows."""
    side = 60
    line = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(side, side))
    matrix = sp.csc_matrix(sp.kronsum(line, line) + 1e-3 * sp.identity(side**2))
    values = np.ones((side**2, 3))
    start = process_time()
    factor = splu(matrix)
    for _ in range(10):
        values = factor.solve(values)
        values /= np.linalg.norm(values)
    return process_time() - start
