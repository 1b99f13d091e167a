"""Diaphragms at rest in tanks that are no spheres, upright, on their side and upside down."""

from __future__ import annotations

import numpy as np
import pytest

from cloth.level import level_shape
from coupling.fluids.hydrostatic import Hydrostatic
from coupling.scene.scene import Scene, SceneError, scene_from
from coupling.structure.diaphragm import FOLDED, Diaphragm, diaphragm_of, settle_diaphragm

UPRIGHT, SIDE, OVER = (0.0, 0.0, -9.81), (9.81, 0.0, 0.0), (0.0, 0.0, 9.81)
PILL = {"shape": "pill", "radius": 0.2, "cylinder_length": 0.4}
EGG = {"shape": "ellipsoid", "radius": 0.2, "semi_axis": 0.14}


def scene(tank: dict[str, object], gravity: tuple[float, ...], fill: float, mould: str) -> Scene:
    return scene_from(
        {
            "gravity": gravity,
            "tank": tank,
            "diaphragm": {"material": "AF-E-332", "thickness": 0.0018, "mould": mould},
            "liquid": {"name": "water", "fill_fraction": fill},
            "model": {"fluid": "hydrostatic"},
            "cloth": {"resolution": 8},
            "time": {"duration": 0.1, "step": 0.01},
        }
    )


def centre(chosen: Scene, cloth: Diaphragm, position: np.ndarray) -> np.ndarray:
    """Of gravity (3,) [m] of the liquid below the sheet at ``position`` (n, 3) [m]."""
    corners = position[cloth.triangles]
    cone = np.einsum("td,td->t", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 24.0
    moment = (cone[:, None] * corners.sum(axis=1)).sum(axis=0)
    moment[2] += chosen.tank.shell.moment_below(0.0)
    return np.asarray(moment / chosen.liquid_volume)


@pytest.mark.parametrize(
    ("tank", "gravity", "fill", "mould"),
    [
        (PILL, UPRIGHT, 0.3, "lower"),
        (PILL, UPRIGHT, 0.8, "upper"),
        (PILL, SIDE, 0.3, "upper"),
        (PILL, SIDE, 0.8, "upper"),
        (PILL, OVER, 0.8, "upper"),
        (EGG, SIDE, 0.6, "lower"),
        ({"radius": 0.2, "clamp_height": 0.08}, UPRIGHT, 0.7, "lower"),
    ],
)
def test_a_diaphragm_comes_to_rest(
    tank: dict[str, object], gravity: tuple[float, ...], fill: float, mould: str
):
    """Its volume to 1e-12, inside the shell; gravity that is turned draws the CG along."""
    chosen = scene(tank, gravity, fill, mould)
    cloth = diaphragm_of(chosen)
    down = np.array(gravity)
    load = Hydrostatic(density=1000.0).load(down, chosen.liquid_volume)
    left = settle_diaphragm(cloth, chosen, load)
    assert left is not None
    assert left <= FOLDED
    state = cloth.state
    assert state.volume == pytest.approx(chosen.liquid_volume, rel=1e-12)
    assert chosen.tank.shell.gap(state.position).min() >= -1e-12
    level = level_shape(cloth.model, chosen.liquid_volume)
    drawn = (centre(chosen, cloth, state.position) - centre(chosen, cloth, level)) @ down
    assert drawn > (0.1 * 0.2 * 9.81 if gravity != UPRIGHT else -0.01 * 0.2 * 9.81)


def test_a_fill_that_the_diaphragm_cannot_hold_is_refused():
    tank = {"radius": 0.2, "clamp_height": 0.08}
    with pytest.raises(SceneError, match=r"fill_fraction: .* holds fill fractions from 0.5"):
        scene(tank, UPRIGHT, 0.3, "upper")
