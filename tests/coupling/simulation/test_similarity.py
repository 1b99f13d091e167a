"""Similar tanks move alike: every constant is in units of the scene's own lengths and forces."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from coupling.scene.scene import scene_from
from coupling.simulation.driver import run
from coupling.store.results import read_results

THICKNESS, MODULUS, FREQUENCY, AMPLITUDE, STEP = 0.004 * 0.4445, 8.6e6, 1.25, 0.1, 0.01


def path(
    folder: Path, fluid: str, *, size: float = 1.0, gravity: float = 1.0, weight: float = 1.0
) -> np.ndarray:
    """CG (T, 3) [-], over the radius, of a sway at the same Froude, Reynolds and Cauchy numbers.

    ``size`` of the tank over 0.4445 m, ``gravity`` over 9.81 m/s^2, ``weight`` of both densities
    over water's and rubber's. E goes with rho g R, times with sqrt(R/g), the viscosity with
    R sqrt(g R).
    """
    slower = math.sqrt(size / gravity)
    scene = {
        "gravity": [0.0, 0.0, -9.81 * gravity],
        "tank": {"radius": 0.4445 * size},
        "diaphragm": {
            "thickness": THICKNESS * size,
            "density": 1070.0 * weight,
            "youngs_modulus": MODULUS * weight * gravity * size,
            "poisson_ratio": 0.5,
        },
        "liquid": {
            "density": 1000.0 * weight,
            "viscosity": 1e-6 * size**2 / slower,
            "fill_fraction": 0.8,
        },
        "motion": {
            "kind": "sine",
            "frequency": FREQUENCY / slower,
            "amplitude": AMPLITUDE * size,
            "ramp": 0.5,
        },
        "model": {"fluid": fluid},
        "cloth": {"resolution": 8},
        "time": {"duration": 0.8 * slower, "step": STEP * slower, "output_every": 1},
    }
    summary = run(scene_from(scene), folder)
    assert (summary["status"], summary["coupling"]["unconverged_steps"]) == ("completed", 0)
    return np.asarray(read_results(folder).liquid_cg / (0.4445 * size))


@pytest.mark.parametrize("fluid", ["hydrostatic", "potential"])
@pytest.mark.parametrize(
    "other",
    [{"size": 0.25}, {"gravity": 1.0 / 64.0}, {"weight": 4.0}],
    ids=["small", "weightless", "heavy"],
)
def test_similar_tanks_move_alike(tmp_path: Path, fluid: str, other: dict[str, float]) -> None:
    """A tank of a quarter of the size, in 1/64 g, or four times as heavy: bit for bit the same."""
    wanted = path(tmp_path / "one", fluid)
    found = path(tmp_path / "other", fluid, **other)
    moved = np.abs(wanted - wanted[0]).max()
    assert moved > 0.01
    # Every number of a run is the other's times a power of two, and so is every square root: the
    # arithmetic rounds alike, and the smallest constant with a hidden unit would show.
    assert np.array_equal(found, wanted)
