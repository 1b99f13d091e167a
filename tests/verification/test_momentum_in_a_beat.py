"""Newton's law for the liquid in a beat, where force and acceleration have no common phasor."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from coupling.scene.scene import scene_from
from coupling.simulation.driver import run

FREQUENCY = 1.25  # Hz; a free surface at half fill sloshes at 0.93 Hz
ACCELERATION = 0.981  # m/s^2, a tenth of gravity's


def test_force_and_momentum_agree_in_a_beat_whatever_is_written_out(tmp_path: Path) -> None:
    """Within 1 % of the force, which is here an eighth of the mass times the tank's acceleration.

    12 rings: 0.5 %; 16: 0.13 %. Of a liquid without viscosity: the force is that of the pressure
    alone, and the shear that water has at the walls is 1.3 % of it.
    """
    scene = scene_from(
        {
            "tank": {"radius": 0.4445},
            "diaphragm": {
                "thickness": 1.778e-3, "density": 1070.0, "youngs_modulus": 8.6e6,
                "poisson_ratio": 0.5,
            },
            "liquid": {"density": 1000.0, "viscosity": 1e-14, "fill_fraction": 0.5},
            "motion": {"kind": "sine", "frequency": FREQUENCY, "acceleration": ACCELERATION},
            "model": {"fluid": "potential"},
            "cloth": {"resolution": 12, "fold_damping": 14.0},
            "time": {"periods": 6.0, "step": 0.005, "output_every": 16},
        }
    )  # fmt: skip
    summary = run(scene, tmp_path)
    assert summary["status"] == "completed"
    force, fitted = summary["force"], summary["fitted_periods"]
    assert force["transient"] is True
    assert fitted == 2
    push = scene.liquid.density * scene.liquid_volume * ACCELERATION
    assert np.linalg.norm(force["amplitude_N"]) < 0.2 * push
    assert force["momentum_imbalance"] < 0.01
