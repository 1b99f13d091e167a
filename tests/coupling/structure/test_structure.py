"""The diaphragm of a scene: what it is built from, where it settles, where the liquid lies."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from water_tank import GRAVITY, RADIUS, scene

from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere
from cloth.thesis.sheet import ThesisSheet
from coupling.fluids.datum import Datum
from coupling.fluids.hydrostatic import Hydrostatic
from coupling.interface.liquid_shape import liquid_cg
from coupling.ports import RunFailed
from coupling.scene.scene import load_scene
from coupling.structure.diaphragm import COMPRESSIVE, diaphragm_of, settle_diaphragm

CASES = Path(__file__).parents[3] / "foam_cases"


def test_cg_of_a_full_ball_is_its_centre():
    cloth = hemisphere(RADIUS, 24)
    errors = []
    for rings in (12, 24):
        cloth = hemisphere(RADIUS, rings)
        volume = 4 / 3 * np.pi * RADIUS**3
        errors.append(abs(liquid_cg(cloth.points, cloth.triangles, Sphere(RADIUS), volume)[2]))
    assert errors[1] < 0.3 * errors[0]  # the inscribed triangles miss O(h^2) of the upper half
    assert errors[1] < 0.002 * RADIUS


def test_cg_of_half_a_ball():
    cloth = hemisphere(RADIUS, 8)
    flat = cloth.points * [1, 1, 0]
    cg = liquid_cg(flat, cloth.triangles, Sphere(RADIUS), 2 / 3 * np.pi * RADIUS**3)
    np.testing.assert_allclose(cg, [0, 0, -3 / 8 * RADIUS], atol=1e-12)


def test_a_clamped_rim_resists_the_slope_that_a_hinged_one_gives_way_to():
    """The moulded shape leaning inward, by the same angle all along the rim."""
    rubber = {"material": "AF-E-332", "thickness": 0.001778}
    leaning = hemisphere(RADIUS, 10).points
    leaning[:, :2] *= 1.0 - 0.05 * leaning[:, 2:] / RADIUS
    moment = {}
    for rim in ("hinged", "clamped"):
        model = diaphragm_of(scene(diaphragm={**rubber, "rim": rim})).model
        moment[rim] = np.abs(model.bending_force(leaning)).max()
    assert moment["clamped"] > 2.0 * moment["hinged"]


def test_settles_at_the_level_of_the_spherical_cap():
    chosen = scene()
    cloth = diaphragm_of(chosen)
    load = Hydrostatic(density=998.0).load(GRAVITY, chosen.liquid_volume)
    settle_diaphragm(cloth, chosen, load)
    state = cloth.state
    assert abs(state.volume / chosen.liquid_volume - 1) < 1e-9
    level = 0.4257  # 1/2 + 3h/4 - h^3/4 = 0.8
    crown = state.position[np.linalg.norm(state.position[:, :2], axis=1) < 0.5 * RADIUS, 2]
    # Ten rings: the lying part is cut off by triangles, O(h^2/8R) of its height.
    assert abs(crown.mean() / RADIUS - level) < (np.pi / 20) ** 2 / 2


def test_the_thesis_diaphragm_settles_for_the_given_time_at_its_datum():
    chosen = scene(
        cloth={"grid": "thesis", "resolution": 6},
        model={"fluid": "datum"},
        time={"duration": 0.1, "settle": 0.05, "step": 0.0005},
    )
    cloth = diaphragm_of(chosen)
    assert isinstance(cloth, ThesisSheet)
    assert cloth.step == 0.0005  # the scene's, where it is shorter than the thesis' 1 ms
    assert cloth.triangles.shape == (2 * 5 * 5, 3)
    load = Datum(density=998.0, shell=Sphere(RADIUS)).load(GRAVITY, chosen.liquid_volume)
    settle_diaphragm(cloth, chosen, load)
    by_hand = diaphragm_of(chosen)
    by_hand.begin_step(0.05, load)
    by_hand.solve(np.zeros_like(by_hand.reference))
    by_hand.accept_step()
    np.testing.assert_array_equal(cloth.state.position, by_hand.state.position)
    assert cloth.state.volume > 0.0005 * chosen.tank.volume  # it has risen from the moulded shape
    assert cloth.state.datum_pressure == load.datum


def test_the_thesis_diaphragm_refuses_a_liquid_of_constant_volume():
    chosen = scene(cloth={"grid": "thesis", "resolution": 6}, model={"fluid": "datum"})
    load = Hydrostatic(density=998.0).load(GRAVITY, chosen.liquid_volume)
    with pytest.raises(ValueError, match=r"no volume constraint.*model\.fluid"):
        settle_diaphragm(diaphragm_of(chosen), chosen, load)


def test_held_diaphragm_stays():
    chosen = scene(diaphragm={"material": "AF-E-332", "thickness": 0.001778, "held": True})
    cloth = diaphragm_of(chosen)
    load = Hydrostatic(density=998.0).load(GRAVITY, chosen.liquid_volume)
    settle_diaphragm(cloth, chosen, load)
    before = cloth.state.position
    cloth.begin_step(0.01, replace(load, body_force=np.array([15.0, 0.0, -9.81])))
    after = cloth.solve(np.zeros_like(before))
    np.testing.assert_array_equal(after, before)


def test_a_diaphragm_with_its_compliance_stretches_by_tension_over_e_t():
    strains = {}
    for inextensible in (True, False):
        rubber = {"material": "AF-E-332", "thickness": 0.001778, "inextensible": inextensible}
        chosen = scene(diaphragm=rubber)
        cloth = diaphragm_of(chosen)
        load = Hydrostatic(density=998.0).load(GRAVITY, chosen.liquid_volume)
        settle_diaphragm(cloth, chosen, load)
        strains[inextensible] = cloth.state.strain.max()
        stretched = cloth.state.tension.max() / chosen.diaphragm.sheet.membrane_stiffness
    assert strains[True] < 0.5 / chosen.cloth.stiffness  # of the tension rho b R^2/2 at most
    # e1 = (T1 - nu T2)/(E t) with 0 <= T2 <= T1 and nu = 1/2.
    assert 0.5 * stretched < strains[False] < 1.02 * stretched
    assert stretched > 1e-3


def test_resolved_wrinkles_stand_on_the_sheets_own_stiffness():
    thick = {"material": "AF-E-332", "thickness": 0.01}  # so that few rings are enough
    for wrinkling in ("relaxed", "resolved"):
        chosen = scene(diaphragm=thick, cloth={"resolution": 12, "wrinkling": wrinkling})
        stiffness = diaphragm_of(chosen).model.compressive
        own = chosen.diaphragm.sheet.membrane_stiffness
        unit = chosen.liquid.density * 9.81 * chosen.tank.radius**2
        expected = own if wrinkling == "resolved" else COMPRESSIVE * unit  # far from buckling
        np.testing.assert_allclose(stiffness, expected, rtol=1e-14)


def test_a_half_full_sheet_of_18_rings_comes_to_rest():
    """It moved on by 7e-4 m a step: the shell's penalty held it back from sliding."""
    chosen = load_scene(CASES / "slosh", ["cloth.resolution=18"])
    cloth = diaphragm_of(chosen)
    density = chosen.liquid.density
    load = Hydrostatic(density=density).load(GRAVITY, chosen.liquid_volume)
    assert settle_diaphragm(cloth, chosen, load) < 1e-6


def test_says_when_no_rest_is_found():
    chosen = scene()
    cloth = diaphragm_of(chosen)
    # More liquid than the moulded triangles can enclose: there is no equilibrium to be found.
    load = Hydrostatic(density=998.0).load(GRAVITY, 1.02 * chosen.tank.volume)
    with pytest.raises((RunFailed, ArithmeticError), match=r"settling|diverge"):
        settle_diaphragm(cloth, chosen.model_copy(update={"liquid": _fuller(chosen)}), load)


def test_a_sheet_that_never_rests_can_start_as_it_creeps():
    # Ten times as heavy as its liquid it sinks in ever new folds.
    heavy = {"density": 10700.0, "youngs_modulus": 8.6e6, "poisson_ratio": 0.5}
    chosen = scene(
        diaphragm=heavy | {"thickness": 0.001778}, time={"duration": 0.1, "settle_tolerance": 1e-3}
    )
    cloth = diaphragm_of(chosen)
    load = Hydrostatic(density=998.0).load(GRAVITY, chosen.liquid_volume)
    left = settle_diaphragm(cloth, chosen, load)
    assert left is not None
    assert 1e-6 < left <= 1e-3
    assert np.abs(cloth.state.velocity).max() == 0.0


def _fuller(chosen):
    return chosen.liquid.model_copy(update={"fill_fraction": 1.02})
