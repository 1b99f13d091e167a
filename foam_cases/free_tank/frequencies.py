"""Holds a free tank's own frequencies against those of its mechanical model.

    python foam_cases/free_tank/frequencies.py RUN MODEL

RUN: the folder of a run of this case; MODEL: of an `edt identify` of
`foam_cases/mechanical_model` at the same fill. The tank's displacement, once nothing pushes it, is
taken for damped sines.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.optimize import least_squares

from coupling.scene.scene import Scene, load_scene
from coupling.store.results import open_results
from coupling.structure.diaphragm import diaphragm_of

Array = NDArray[np.float64]
PUSHED = 0.35  # s: by then the push is over


def by_model(row: dict[str, Any], tank: float, spring: float) -> tuple[Array, Array]:
    """Frequencies [Hz] of masses on springs, and the tank's share of each one's motion.

    ``tank`` [kg]: mass of tank and diaphragm, on a ``spring`` [N/m] to the ground; ``row``: what
    was identified of the liquid.
    """
    masses = np.array([mode["mass_kg"] for mode in row["modes"]])
    omegas = 2.0 * np.pi * np.array([mode["frequency_hz"] for mode in row["modes"]])
    springs = masses * omegas**2
    stiffness = np.diag(np.concatenate([[spring + springs.sum()], springs]))
    stiffness[0, 1:] = stiffness[1:, 0] = -springs
    square, shape = eigh(stiffness, np.diag([tank + row["fixed_mass_kg"], *masses]))
    share = shape[0] ** 2 / square**0.5  # of a push's answer
    return np.sqrt(square) / (2.0 * np.pi), share / share.sum()


def by_run(time: Array, moved: Array, start: Array) -> tuple[Array, Array, float]:
    """Frequencies [Hz] and damping ratios of ``moved``, and what they miss of its rms.

    ``start`` [Hz]: where the frequencies are looked for.
    """
    count = len(start)

    def waves(values: Array) -> Array:
        omega, damping = 2.0 * np.pi * values[:count], values[count:]
        decay = np.exp(-np.outer(time, damping * omega))
        angle = np.outer(time, omega)
        return np.hstack([decay * np.cos(angle), decay * np.sin(angle)])

    def left(values: Array) -> Array:
        columns = waves(values)
        return moved - columns @ np.linalg.lstsq(columns, moved, rcond=None)[0]

    first = np.concatenate([start, np.full(count, 0.01)])
    found = least_squares(left, first, x_scale=np.concatenate([start, np.full(count, 0.01)]))
    missed = float(np.sqrt(np.mean(found.fun**2) / np.mean(moved**2)))
    return found.x[:count], found.x[count:], missed


def masses_of(scene: Scene) -> float:
    """Of tank and diaphragm [kg]."""
    assert scene.carrier.mass is not None
    return scene.carrier.mass + float(diaphragm_of(scene).mass.sum())


def main() -> None:
    """Print a table of both."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("run", type=Path)
    parser.add_argument("model", type=Path)
    given = parser.parse_args()
    scene, steps = load_scene(given.run), open_results(given.run).steps
    content = json.loads((given.model / "mechanical_model.json").read_text(encoding="utf-8"))
    (row,) = (row for row in content["rows"] if row["fill_fraction"] == scene.liquid.fill_fraction)
    exact, share = by_model(row, masses_of(scene), scene.carrier.springs[0])
    free = steps.time > PUSHED
    found, damping, missed = by_run(steps.time[free], steps.tank_displacement[free, 0], exact)
    print("| share of the answer | model [Hz] | run [Hz] | run over model | damping ratio |")
    print("|---|---|---|---|---|")
    for parts in zip(share, exact, found, found / exact - 1.0, damping, strict=True):
        print("| {:.1%} | {:.4f} | {:.4f} | {:+.2%} | {:.4f} |".format(*parts))
    print(f"The sines miss {missed:.1%} of the displacement's rms.")


if __name__ == "__main__":
    main()
