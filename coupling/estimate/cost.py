"""How long a run will take, roughly: to a factor of two, on a core that is free.

All constants are CPU seconds of one core of the machine of the runs that ``test_cost`` holds the
estimates against; ``slowness`` says how this machine compares. With the scheme ``added-mass`` half
of a flow's step or more is the added mass, made once: whether it takes two iterations or four
changes the step by a quarter, and how many it will be is not asked. The other schemes' iterations
are those of README's table.
"""

from __future__ import annotations

from functools import lru_cache
from time import process_time

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from coupling.finite_volume.mesh import cells_made, half_ball
from coupling.foam.solver_cache import built_for_any
from coupling.scene.scene import Scene

_INNER = 40  # iterations of a solve of the cloth
_CLOTH_ITERATION = 6e-4  # an inner iteration of 24 rings, a step's overhead spread over ten
_SETTLING = 11000  # inner iterations of a settling
_POTENTIAL = 30  # what a potential adds to a step, in inner iterations
_COUPLED_SOLVES = 3.0  # of the cloth in a coupled step with the scheme added-mass
_ITERATIONS = {"iqn-ils": 11.0, "aitken": 35.0, "fixed-point": 35.0}  # of a step, in its place
_RESTART = 0.09  # of a flow's solver, for every iteration
_COUPLED_ROWS = 120  # what the rows of a flow's added mass add to it, in inner iterations
_CELLS = 1216  # that the next two are for
_ADDED_MASS, _GROWTH = 0.05, 1.6  # by a sparse factor; its growth with the cells
_FLOW_SOLVES = 0.045  # in a step of _COUPLED_SOLVES
FACTOR = 2.0  # that an estimate may be off, either way
_REFERENCE = 0.036  # [s] of ``_kernel`` on the machine of the constants above


def step_cost(scene: Scene, fluid: str) -> float:
    """Estimated time of one step [s] with ``fluid`` in place of the scene's own model.

    The cloth's share grows with its triangles and inner iterations, the flow's with its cells.
    """
    inner = _iteration_cost(scene)
    if fluid == "potential":
        return inner * (_INNER + _POTENTIAL)
    if fluid != "openfoam":
        return inner * _INNER
    solves = _ITERATIONS.get(scene.coupling.scheme, _COUPLED_SOLVES)
    size = cells_made(scene.openfoam.cells) / _CELLS
    flow = solves * (_FLOW_SOLVES / _COUPLED_SOLVES * size + _RESTART * (not _stays_alive(scene)))
    cloth = inner * solves * _INNER
    if scene.coupling.scheme in _ITERATIONS:
        return float(cloth + flow)
    return float(cloth + inner * _COUPLED_ROWS + _ADDED_MASS * size**_GROWTH + flow)


def _stays_alive(scene: Scene) -> bool:
    return scene.openfoam.keep_alive and built_for_any()


def _iteration_cost(scene: Scene) -> float:
    return float(_CLOTH_ITERATION * (scene.cloth.rings / 24.0) ** 2.3)


def run_cost(scene: Scene, fluid: str) -> float:
    """Estimated time of the whole run [s], settling (always without a flow) included."""
    return _SETTLING * _iteration_cost(scene) + scene.time.steps * step_cost(scene, fluid)


def fields_size(scene: Scene) -> float:
    """Bytes on disk that ``openfoam.write_fields`` takes: p, U and points at the times of output.

    What belongs to checkpoints, which keep more of a time, and the files' heads are left out.
    """
    mesh = half_ball(scene.openfoam.cells)
    values = mesh.cells + len(mesh.faces) - mesh.inner_faces  # in the cells and on the walls
    times = -(-scene.time.steps // scene.time.output_every)
    return 8.0 * times * (4 * values + 3 * len(mesh.points))


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
