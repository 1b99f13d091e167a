"""Dimensionless numbers against the thesis and against exact answers."""

import numpy as np
import pytest

from cloth.shell.sphere import fill_fraction_of_level, level_of_fill_fraction
from coupling.estimate.numbers import (
    added_mass_ratio,
    bond_number,
    free_surface,
    froude_number,
    hydrostatic_error,
    membrane_parameter,
    numbers_of,
    slosh_eigenvalue,
    slosh_frequency,
    weber_number,
)
from coupling.estimate.sloshing_modes import lateral_eigenvalue
from coupling.scene.scene import Scene, scene_from
from coupling.scene.wrinkles import elasto_gravity_wavelength, rings_to_resolve
from coupling.verify import run_case


def pad_sway(**motion: object) -> Scene:
    return tank(motion=motion or {"kind": "sine", "frequency": 1.25, "amplitude": 0.25})


def tank(**sections: object) -> Scene:
    base = {
        "tank": {"radius": 0.4445},
        "diaphragm": {"thickness": 0.001778, "material": "AF-E-332"},
        "liquid": {"density": 1000.0, "viscosity": 1e-6, "fill_fraction": 0.8},
        "time": {"duration": 1.0},
    }
    return scene_from(base | sections)


@pytest.mark.parametrize("fill_fraction", [0.0, 1e-9, 0.01, 0.2, 0.5, 0.8, 0.999, 1.0])
def test_level_inverts_the_volume_of_the_cap(fill_fraction: float):
    level = level_of_fill_fraction(fill_fraction)
    # The arc cosine near its end loses half the digits: sqrt(eps) in the level, eps in the volume.
    assert fill_fraction_of_level(level) == pytest.approx(fill_fraction, rel=1e-6, abs=1e-15)


def test_level_is_exact_where_it_is_known():
    assert level_of_fill_fraction(0.5) == pytest.approx(1.0, rel=1e-15)
    assert level_of_fill_fraction(5.0 / 32.0) == pytest.approx(0.5, rel=1e-14)
    with pytest.raises(ValueError, match=r"must lie in \[0, 1\]"):
        level_of_fill_fraction(1.4)


@pytest.mark.parametrize(
    ("level", "eigenvalue"),
    [(0.4, 1.1583), (0.6, 1.2625), (1.0, 1.560157), (1.4, 2.1232), (1.6, 2.6863), (1.8, 3.9593)],
)
def test_eigenvalue_is_the_tabulated_one(level: float, eigenvalue: float):
    """McIver's table (J. Fluid Mech. 201, 1989), to half of its last digit and the polynomials'."""
    digit = 1e-6 if level == 1.0 else 1e-4
    assert slosh_eigenvalue(level) == pytest.approx(eigenvalue, abs=0.51 * digit, rel=2e-5)


@pytest.mark.parametrize(("level", "allowed"), [(0.05, 1e-6), (1.5, 1e-6), (1.8, 2e-5)])
def test_few_polynomials_are_as_good_as_many(level: float, allowed: float):
    assert slosh_eigenvalue(level) == pytest.approx(lateral_eigenvalue(level, 1), rel=allowed)


def test_eigenvalue_rises_from_the_shallow_bowl_to_the_small_opening():
    levels = np.array([1e-4, 0.01, 0.1, 0.5, 1.0, 1.5, 1.79, 1.81, 1.9, 1.95, 1.98])
    values = np.array([slosh_eigenvalue(level) for level in levels])
    assert (np.diff(values) > 0).all()
    assert values[0] == pytest.approx(1.0, abs=1e-4)
    # lambda a/R rises to 2.754755 with a = sqrt(h (2 - h)) R, the opening's radius.
    slopes = values[-3:] * np.sqrt(levels[-3:] * (2.0 - levels[-3:]))
    assert (np.diff(slopes) > 0).all()
    assert slopes[-1] < 2.754755
    with pytest.raises(ValueError, match=r"must lie in \(0, 2\)"):
        slosh_eigenvalue(2.0)


def test_a_cover_is_so_much_less_gravity():
    """omega^2 (M + cover) = g k of every mode: that of g - cover R omega^2 without it."""
    covered = slosh_frequency(eigenvalue=1.56, radius=0.5, gravity=9.81, cover=0.01)
    omega = 2.0 * np.pi * covered
    less = 9.81 - 0.01 * 0.5 * omega**2
    bare = slosh_frequency(eigenvalue=1.56, radius=0.5, gravity=less)
    assert bare == pytest.approx(covered, rel=1e-12)


def test_slosh_frequency_of_the_half_full_tank():
    # sqrt(1.560157 * 9.81/0.4445)/(2 pi), from the table's exact value.
    _, eigenvalue = free_surface(tank(liquid={"name": "water", "fill_fraction": 0.5}))
    frequency = slosh_frequency(eigenvalue=eigenvalue, radius=0.4445, gravity=9.81)
    assert frequency == pytest.approx(0.933905, rel=1e-6)


def test_thesis_ranges():
    hydrazine = {"density": 1010.0, "surface_tension": 0.062}
    assert bond_number(gravity=9.81, radius=0.120, **hydrazine) == pytest.approx(2300, rel=1e-3)
    assert bond_number(gravity=9.81, radius=0.508, **hydrazine) == pytest.approx(41240, rel=1e-4)
    weber = weber_number(frequency=25.0, radius=0.508, **hydrazine)
    assert weber == pytest.approx(1.33e6, rel=0.005 / 1.33)  # printed to three digits
    bond = bond_number(gravity=9.81, radius=0.508, **hydrazine)
    froude = froude_number(frequency=25.0, radius=0.508, gravity=9.81)
    assert froude == pytest.approx(weber / bond, rel=1e-14)


def test_equation_4_6_in_both_readings():
    printed, worded = run_case("eq46").quantities
    assert round(printed.computed) == 1118  # as the thesis prints it
    assert worded.computed == pytest.approx(printed.computed / 4.0, rel=1e-14)
    assert worded.error < 0.5 / 1118  # half of the last printed digit


def test_pad_sway_is_above_resonance_and_wants_a_flow():
    numbers = numbers_of(pad_sway())
    # 1.104 Hz of the liquid alone, less the sheet's 1.90 kg/m^2 over rho R = 444.5, lambda 2.18
    assert numbers.slosh_frequency == pytest.approx(1.104 / np.sqrt(1.0093), abs=5e-4)
    assert numbers.hydrostatic_error == pytest.approx((1.25 / numbers.slosh_frequency) ** 2)
    assert numbers.membrane_parameter == pytest.approx(0.2357, abs=5e-4)
    assert 0.160 < numbers.elasto_gravity_wavelength < 0.172
    assert numbers.bond is None
    assert numbers.weber is None


def test_rest_is_hydrostatic_and_a_table_has_the_frequency_of_its_energy(tmp_path):
    assert numbers_of(pad_sway(kind="rest")).hydrostatic_error == 0.0
    (tmp_path / "t.csv").write_text("0,0,0,0\n2,0,0,0\n")
    still = numbers_of(pad_sway(kind="table", file=str(tmp_path / "t.csv")))
    assert (still.frequency, still.acceleration_ratio) == (0.0, 0.0)
    time = np.arange(0.0, 10.0, 0.02)
    wave = 2.0 * np.sin(2 * np.pi * 1.5 * time)
    lines = (f"{t},{a},0,0" for t, a in zip(time, wave, strict=True))
    (tmp_path / "t.csv").write_text("\n".join([*lines, "10,0,0,0"]))
    table = numbers_of(pad_sway(kind="table", file=str(tmp_path / "t.csv")))
    assert table.frequency == pytest.approx(1.5, abs=0.1)  # one over the table's length
    assert table.acceleration_ratio == pytest.approx(2.0 / 9.81, rel=1e-3)


def test_what_the_grid_can_show_of_the_wrinkles():
    coarse, fine = tank(), tank(cloth={"resolution": 41})
    assert numbers_of(coarse).grid_spacing == pytest.approx(0.4445 * np.pi / 48)
    assert numbers_of(coarse).wrinkling_allowed == "relaxed"
    # kappa = E t^3/9; 10 spacings of pi R/2/rings to 2 pi (kappa/(rho g))^(1/4).
    wavelength = 2 * np.pi * (8.6e6 * 0.001778**3 / 9 / 9810) ** 0.25
    assert numbers_of(fine).elasto_gravity_wavelength == pytest.approx(wavelength)
    assert 40 < 10 * 0.4445 * np.pi / 2 / wavelength < 41
    assert numbers_of(fine).rings_to_resolve == 41
    assert numbers_of(fine).wrinkling_allowed == "resolved"
    assert numbers_of(tank(cloth={"resolution": 40})).wrinkling_allowed == "relaxed"
    assert rings_to_resolve(1.0, 0.5) == 20  # exactly ten to each


def test_the_thesis_grid_has_half_as_many_rings_as_nodes_across():
    numbers = numbers_of(tank(cloth={"grid": "thesis"}, model={"fluid": "datum"}))
    assert numbers.grid_spacing == pytest.approx(0.4445 * np.pi / 2 / 13)
    assert numbers.wrinkling_allowed == "relaxed"
    finest = {"grid": "thesis", "resolution": 100}
    finest = numbers_of(tank(cloth=finest, model={"fluid": "datum"}))
    assert finest.wrinkling_allowed == "relaxed"  # whatever its spacing: it knows no wrinkling


def test_the_membrane_stretches_by_the_largest_body_force(tmp_path):
    stiffness = 8.6e6 * 0.001778 / (1000 * 0.4445**2)
    rest = numbers_of(pad_sway(kind="rest"))
    assert rest.largest_body_force == pytest.approx(9.81)
    assert rest.membrane_parameter == pytest.approx(9.81 / stiffness)
    assert round(rest.membrane_parameter, 2) == 0.13
    sway = numbers_of(pad_sway())
    acceleration = 0.25 * (2 * np.pi * 1.25) ** 2
    assert sway.largest_body_force == pytest.approx(np.hypot(9.81, acceleration))
    assert round(sway.membrane_parameter, 2) == 0.24
    # Up and down: both signs of the acceleration are tried, and the direction is made a unit's.
    for up in (3.0, -3.0):
        heave = {"frequency": 1.25, "amplitude": 0.25, "direction": [0.0, 0.0, up]}
        heaving = numbers_of(pad_sway(kind="sine", **heave))
        assert heaving.largest_body_force == pytest.approx(9.81 + acceleration)
    (tmp_path / "t.csv").write_text("0,0,0,0\n1,0,0,-9.81\n1.5,0,3,-5.81\n2,0,0,5\n")
    table = numbers_of(pad_sway(kind="table", file=str(tmp_path / "t.csv")))
    assert table.largest_body_force == pytest.approx(14.81)


def test_plain_formulas():
    assert hydrostatic_error(0.5, 1.0) == 0.25
    assert elasto_gravity_wavelength(
        bending_stiffness=1.0, density=1.0, gravity=1.0
    ) == pytest.approx(2 * np.pi)
    assert membrane_parameter(
        density=1000.0, body_force=10.0, radius=0.5, youngs_modulus=1e6, thickness=0.001
    ) == pytest.approx(2.5)
    ratio = added_mass_ratio(density=1000.0, radius=0.5, area_density=2.0, eigenvalue=1.25)
    assert ratio == pytest.approx(200.0)
