"""How long a run will take, roughly: to a factor of two, on a core that is free.

All constants are CPU seconds of one core of the machine of the runs that ``test_cost`` holds the
estimates against; ``slowness`` says how this machine compares. What a
liquid adds to a step its fluid model says.
"""

from __future__ import annotations

from functools import lru_cache
from time import process_time

import numpy as np
from threadpoolctl import threadpool_limits

from coupling.fluids import FLUIDS
from coupling.scene.scene import Scene

_CLOTH_ITERATION = 6e-4  # an inner iteration of 24 rings, a step's overhead spread over ten
_SETTLING = 11000  # inner iterations of a settling
FACTOR = 2.0  # that an estimate may be off, either way
_REFERENCE = 0.015  # [s] of ``_kernel`` on the machine of the constants above


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

    The work is the elimination of a sparse matrix, as most of a step is; the least of three times
    counts, which other programs disturb least.
    """
    return min(_kernel() for _ in range(3)) / _REFERENCE


def _kernel() -> float:
    """CPU time [s] of factoring and solving with a matrix of 3600 rows, the Laplacian of a square.

    By block elimination with NumPy alone: SciPy's sparse solvers, by which the reference was
    measured first, take longer to import than all else that ``edt check`` does. In 180 pairs, on a
    machine with much else to do, this took 0.42 of their time, and 0.33 to 0.53 in eight of ten.
    """
    side = 60
    line = 4.001 * np.identity(side) - np.eye(side, k=1) - np.eye(side, k=-1)
    pivots, values = np.empty((side, side, side)), np.ones((side, side, 3))
    with threadpool_limits(1):
        start = process_time()
        pivots[0] = np.linalg.inv(line)
        for row in range(1, side):
            pivots[row] = np.linalg.inv(line - pivots[row - 1])
        for _ in range(10):
            for row in range(1, side):
                values[row] += pivots[row - 1] @ values[row - 1]
            values[-1] = pivots[-1] @ values[-1]
            for row in range(side - 2, -1, -1):
                values[row] = pivots[row] @ (values[row] + values[row + 1])
            values /= np.linalg.norm(values)
        return process_time() - start
