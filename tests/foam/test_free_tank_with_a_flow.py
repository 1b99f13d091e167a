"""A free tank that turns, on OpenFOAM's flow."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coupling.scene.scene import scene_from
from coupling.simulation.driver import run
from coupling.store.results import read_results

pytestmark = pytest.mark.openfoam


def test_a_sphere_turns_as_on_an_irrotational_liquid(tmp_path: Path):
    """Light, pushed and twisted for 0.2 s: a twentieth apart is what 540 cells leave of p*."""
    time = np.linspace(0.0, 0.3, 61)
    size = np.where(time < 0.2, np.sin(np.pi * time / 0.2) ** 2, 0.0)
    given = np.outer(size, [0.0, 60.0, 0.0, 5.0, 3.0, 2.0])
    head = "time (s),fx (N),fy (N),fz (N),mx (N m),my (N m),mz (N m)"
    file = tmp_path / "push.csv"
    np.savetxt(file, np.c_[time, given], delimiter=",", header=head, comments="")
    results = {}
    for fluid in ("potential", "openfoam"):
        scene = scene_from(
            {
                "tank": {"radius": 0.4445},
                "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
                "liquid": {"name": "water", "fill_fraction": 0.6},
                "carrier": {
                    "kind": "free", "mass": 20.0, "inertia": [1.0] * 3, "force_file": str(file),
                },
                "model": {"fluid": fluid}, "cloth": {"resolution": 8},
                "openfoam": {"cells": 540}, "time": {"duration": 0.24, "step": 0.01},
            }
        )  # fmt: skip
        summary = run(scene, tmp_path / fluid)
        assert summary["status"] == "completed"
        assert summary["halved_steps"] == 0
        assert summary["coupling"]["unconverged_steps"] == 0
        results[fluid] = read_results(tmp_path / fluid).steps
    wanted, found = results["potential"], results["openfoam"]
    turned = np.abs(wanted.tank_rotation).max(axis=0)
    assert turned.min() > 0.01
    assert (np.abs(found.tank_rotation - wanted.tank_rotation).max(axis=0) / turned).max() < 0.05
    way = np.abs(wanted.tank_displacement).max()
    assert np.abs(found.tank_displacement - wanted.tank_displacement).max() < 0.05 * way
