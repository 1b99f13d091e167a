"""Where diaphragms come to rest, and how fast: a table over tilt, fill, sheet, tank and grid.

python -P tests/benchmarks/settling.py prints a row a scene in Markdown: CPU seconds and steps of
settling, the force left over rho g R^3, and the largest displacement over R in ten time steps of
5 ms from there. Some minutes.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from time import process_time
from typing import Any

import numpy as np

from cloth.settle import settle
from cloth.step import Cloth
from coupling.ports import HydrostaticLoad
from coupling.scene.scene import Scene
from coupling.structure.diaphragm import diaphragm_of

STEP, STEPS = 0.005, 10
TANK = {
    "fill": 0.5, "rings": 12, "tilt": 0.0, "radius": 0.4445, "thickness": 1.778e-3, "gravity": 1.0,
    "liquid": "water", "wrinkling": "relaxed", "inextensible": True,
}  # fmt: skip


def tanks() -> Iterator[dict[str, Any]]:
    """What differs from ``TANK``; ``tilt`` in degrees, ``gravity`` in g."""
    for fill in (0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98):
        yield {"fill": fill}
    for tilt in (10.0, 30.0, 45.0, 60.0, 90.0):
        for fill in (0.3, 0.5, 0.8):
            yield {"tilt": tilt, "fill": fill}
    for thickness in (0.3e-3, 0.7e-3, 3e-3):
        for fill in (0.3, 0.5, 0.8):
            yield {"thickness": thickness, "fill": fill}
    yield {"thickness": 0.4445e-3, "fill": 0.3}
    yield {"radius": 0.508, "thickness": 1.524e-3, "rings": 24, "liquid": "hydrazine"}
    for radius, thickness in ((0.2032, 0.5e-3), (0.508, 0.5e-3), (0.508, 1e-3)):
        for fill in (0.3, 0.5):
            yield {"radius": radius, "thickness": thickness, "fill": fill}
    for radius in (0.12, 0.6):
        for gravity in (0.01, 1.0, 2.0):
            yield {"radius": radius, "gravity": gravity}
    for fill in (0.3, 0.8):
        yield {"fill": fill, "inextensible": False}
    for fill in (0.3, 0.5, 0.8):
        yield {"radius": 0.12, "thickness": 3e-3, "wrinkling": "resolved", "fill": fill, "rings": 8}
    for rings in (7, 8, 18, 24, 32, 48):
        yield {"rings": rings}


def scene(tank: dict[str, Any]) -> Scene:
    """At rest with the settings of ``tank``."""
    angle = math.radians(tank["tilt"])
    gravity = 9.81 * tank["gravity"] * np.array([math.sin(angle), 0.0, -math.cos(angle)])
    return Scene.model_validate({
        "gravity": gravity.tolist(),
        "tank": {"radius": tank["radius"]},
        "diaphragm": {"material": "AF-E-332"} | {k: tank[k] for k in ("thickness", "inextensible")},
        "liquid": {"name": tank["liquid"], "fill_fraction": tank["fill"]},
        "motion": {"kind": "rest"},
        "model": {"fluid": "hydrostatic"},
        "cloth": {"resolution": tank["rings"], "wrinkling": tank["wrinkling"]},
        "time": {"duration": 1.0},
    })  # fmt: skip


def row(tank: dict[str, Any]) -> str:
    """CPU seconds, steps, force left, motion and outcome of one tank."""
    chosen = scene(TANK | tank)
    cloth = diaphragm_of(chosen)
    assert isinstance(cloth, Cloth)
    load = HydrostaticLoad(
        density=chosen.liquid.density,
        body_force=np.array(chosen.gravity),
        volume=chosen.liquid_volume,
    )
    begin = process_time()
    done = settle(cloth, load)
    seconds, rest = process_time() - begin, cloth.state.position
    for _ in range(STEPS):
        cloth.begin_step(STEP, load)
        cloth.solve(np.zeros_like(rest))
        cloth.accept_step()
    moved = float(np.abs(cloth.state.position - rest).max()) / chosen.tank.radius
    outcome = "at rest" if done.converged else "none found"
    return f"{seconds:.1f} | {done.steps} | {done.residual:.0e} | {moved:.0e} | {outcome}"


def main() -> None:
    """Print the table."""
    logging.disable(logging.WARNING)
    row({"rings": 6})  # compiles
    print("| tank | CPU s | steps | force left | moves | outcome |\n|---|---|---|---|---|---|")
    for tank in tanks():
        name = ", ".join(f"{key} {value}" for key, value in tank.items())
        print(f"| {name} | {row(tank)} |", flush=True)


if __name__ == "__main__":
    main()
