"""The tank of the thesis with water in it, on a coarse cloth."""

import numpy as np

from coupling.scene.scene import scene_from

RADIUS = 0.4445
GRAVITY = np.array([0.0, 0.0, -9.81])


def scene(**sections):
    base = {
        "tank": {"radius": RADIUS},
        "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
        "liquid": {"name": "water", "fill_fraction": 0.8},
        "time": {"duration": 0.1},
        "cloth": {"resolution": 10},
    }
    return scene_from(base | sections)
