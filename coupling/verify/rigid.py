"""Rigid-body limit: below a diaphragm that is held, a shaken tank feels a rigid mass of liquid."""

from __future__ import annotations

from time import perf_counter
from typing import Any

import numpy as np

from coupling.verify.case import CaseError, VerifyResult, quantity
from coupling.verify.whole_run import DENSITY, RADIUS, whole_run

FREQUENCY, AMPLITUDE, DIRECTION = 1.25, 0.05, (1.0, 0.5, 0.25)
STEP, STEPS = 0.005, 6
RINGS = 8  # of the diaphragm's mesh: the answer does not depend on the shape that is held


def rigid(*, fluid: str = "openfoam", resolution: int = 0) -> VerifyResult:
    """A whole run with the diaphragm held where it settled, and the tank shaken from the start.

    ``fluid``: ``openfoam``, with ``resolution`` cells in the flow's mesh, 0 for 176; ``potential``,
    with polynomials of this degree, 0 for 6. The liquid cannot move, so that p* = 0 and the force
    on tank and diaphragm is m_l (g - a_tank), on any mesh. ``dynamic_pressure``: largest |p*| over
    rho |b| R; ``force``: largest error of the force over the largest m_l |b|. Both are 0 to
    rounding.
    """
    clock = perf_counter()
    if fluid not in ("openfoam", "potential"):
        raise CaseError(f"verify rigid: --fluid: must be openfoam or potential, got '{fluid}'.")
    resolution = resolution or {"openfoam": 176, "potential": 6}[fluid]
    scene, results = whole_run("rigid", **_sections(fluid, resolution))
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


def _sections(fluid: str, resolution: int) -> dict[str, dict[str, Any]]:
    return {
        "diaphragm": {"held": True},
        "motion": {
            "kind": "sine", "frequency": FREQUENCY, "amplitude": AMPLITUDE,
            "direction": DIRECTION, "ramp": 0.0,
        },
        "model": {"fluid": fluid},
        "cloth": {"resolution": RINGS},
        fluid: {"cells" if fluid == "openfoam" else "degree": resolution},
        "time": {"duration": STEP * STEPS, "step": STEP},
    }  # fmt: skip
