"""Rigid-body limit: below a diaphragm that is held, a shaken tank feels a rigid mass of liquid."""

from __future__ import annotations

import tempfile
from pathlib import Path
from time import perf_counter

import numpy as np

from coupling.driver import run
from coupling.ports import RunFailed
from coupling.results import read_results
from coupling.scene import scene_from
from coupling.verify.case import CaseError, VerifyResult, quantity

RADIUS, DENSITY, FILL_FRACTION = 0.4445, 1000.0, 0.8
FREQUENCY, AMPLITUDE, DIRECTION = 1.25, 0.05, (1.0, 0.5, 0.25)
STEP, STEPS = 0.005, 6
RINGS = 8  # of the diaphragm's mesh: the answer does not depend on the shape that is held


def rigid(*, fluid: str = "openfoam", resolution: int = 350) -> VerifyResult:
    """A whole run with the diaphragm held where it settled, and the tank shaken from the start.

    ``resolution``: cells of the flow's mesh. The liquid cannot move, so that p* = 0 and the force
    on tank and diaphragm is m_l (g - a_tank), on any mesh. ``dynamic_pressure``: largest |p*| over
    rho |b| R; ``force``: largest error of the force over the largest m_l |b|. Both are 0 to
    rounding.
    """
    clock = perf_counter()
    if fluid != "openfoam":
        raise CaseError(f"verify rigid: fluid must be openfoam, got {fluid}.")
    scene = scene_from(_scene(fluid, resolution), where="verify rigid")
    with tempfile.TemporaryDirectory() as folder:
        summary = run(scene, Path(folder))
        if summary["status"] != "completed":
            raise RunFailed(f"verify rigid: {summary['error']}")
        results = read_results(Path(folder))
    swing = (2 * np.pi * FREQUENCY) ** 2 * AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * results.time)
    swing[0] = 0.0  # time 0 is the settled tank
    body_force = np.asarray(scene.gravity) + np.outer(swing, scene.motion.unit_direction)
    largest = float(np.linalg.norm(body_force, axis=1).max())
    pressure = np.abs(results.dynamic_pressure).max() / (DENSITY * largest * RADIUS)
    mass = DENSITY * scene.liquid_volume
    wrong = np.linalg.norm(results.force - mass * body_force, axis=1).max()
    return VerifyResult(
        case="rigid",
        options={"fluid": fluid, "resolution": resolution},
        quantities=(
            quantity("dynamic_pressure", pressure, 0.0),
            quantity("force", wrong / (mass * largest), 0.0),
        ),
        wall_s=perf_counter() - clock,
    )


def _scene(fluid: str, cells: int) -> dict[str, object]:
    return {
        "title": "Rigid-body limit",
        "tank": {"radius": RADIUS},
        "diaphragm": {"thickness": 1.778e-3, "material": "AF-E-332", "held": True},
        "liquid": {"density": DENSITY, "viscosity": 1e-6, "fill_fraction": FILL_FRACTION},
        "motion": {
            "kind": "sine",
            "frequency": FREQUENCY,
            "amplitude": AMPLITUDE,
            "direction": DIRECTION,
            "ramp": 0.0,
        },
        "model": {"fluid": fluid},
        "cloth": {"resolution": RINGS},
        "openfoam": {"cells": cells},
        "time": {"duration": STEP * STEPS, "step": STEP, "output_every": 1},
    }
