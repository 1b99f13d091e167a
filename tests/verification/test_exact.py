"""Exact answers, on the grids and steps that a test can afford; tolerances from their orders."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jnp_zeros

from cloth.material import diaphragm
from coupling.estimate.sloshing_modes import covered_eigenvalue, lateral_eigenvalue
from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import half_ball
from coupling.verify import CaseError, run_case
from coupling.verify.cylinder import Tank
from coupling.verify.level_tank import DENSITY, GRAVITY, RADIUS
from coupling.verify.plate import plate_frequency
from coupling.verify.prism import prism_mesh
from coupling.verify.slosh import EIGENVALUES


def errors(result):
    return {quantity.name: quantity.error for quantity in result.quantities}


def test_equation_46():
    assert max(errors(run_case("eq46")).values()) < 5e-4  # printed with four digits


def test_numbers():
    found = errors(run_case("numbers"))
    assert found["bond_min"] < 0.05 / 2.3 / 2 + 1e-3  # printed as 2300
    assert found["bond_max"] < 5e-4
    assert found["weber_max"] < 5e-3  # printed with three digits


@pytest.mark.parametrize(
    "fluid", ["potential", pytest.param("openfoam", marks=pytest.mark.openfoam)]
)
def test_rigid_body_limit(fluid):
    found = errors(run_case("rigid", {"fluid": fluid}))
    # No motion, no pressure: rounding alone. The contract's 1e-6 is met by far.
    assert found["dynamic_pressure"] < 1e-12
    assert found["force"] < 1e-12


@pytest.mark.parametrize("case", ["rigid", "momentum", "slosh", "cylinder"])
def test_other_fluids_are_refused(case):
    with pytest.raises(CaseError, match="fluid"):
        run_case(case, {"fluid": "datum"})


def test_lateral_modes_are_those_of_the_literature():
    for (level, mode), printed in EIGENVALUES["sphere"].items():
        digits = 1e-6 if printed == 1.560157 else 1e-4  # half of the last one printed, and rounding
        assert lateral_eigenvalue(level, mode) == pytest.approx(printed, abs=0.51 * digits)


def potential_error(degree, level=1.0, mode=1):
    options = {"fluid": "potential", "level": level, "mode": mode, "resolution": degree}
    return errors(run_case("slosh", {name: str(value) for name, value in options.items()}))[
        "lambda"
    ]


# Degrees that hold the mode, so that the grid's error is what is left: it is of second order.
@pytest.mark.parametrize(
    ("level", "mode", "degrees"),
    [(0.4, 1, (6, 12)), (0.6, 1, (6, 12)), (1.0, 1, (6, 12)), (0.4, 2, (8, 16)), (0.6, 2, (8, 16))],
)
def test_potential_slosh_converges(level, mode, degrees):
    coarse, fine = (potential_error(degree, level, mode) for degree in degrees)
    assert np.log2(coarse / fine) > 1.9


@pytest.mark.parametrize("level", [0.4, 0.6, 1.0, 1.4, 1.6, 1.8])
@pytest.mark.parametrize(("mode", "most"), [(1, 2e-3), (2, 1e-2)])
def test_potential_slosh_by_default(level, mode, most):
    """What a designer may ask of a slosh frequency: omega to 0.1 %, and 0.5 % of the second."""
    assert potential_error(0, level, mode) < most


def backward_energy(angle, steps):
    """What is left of one oscillator's energy: y' = i omega y, ``angle`` = omega dt."""
    before, now = 1.0, 1.0 / (1.0 - 1j * angle)
    for _ in range(steps - 1):
        before, now = now, (4 * now - before) / (3 - 2j * angle)
    return abs(now) ** 2


def test_potential_slosh_in_time_is_one_oscillator():
    step, options = 0.008, {"fluid": "potential", "resolution": "6"}
    in_space = run_case("slosh", options).quantities[0].computed
    moving, kept = run_case("slosh", options | {"step": str(step)}).quantities
    omega = np.sqrt(in_space * GRAVITY / RADIUS)
    # backward lowers omega^2 by 2/3 (omega dt)^2, and by what that leaves of the next order.
    angle = omega * step
    assert moving.computed == pytest.approx(in_space * (1 - 2 / 3 * angle**2), rel=2 * angle**4)
    steps = int(np.ceil(20 * 2 * np.pi / omega / step))
    assert kept.computed == pytest.approx(backward_energy(angle, steps), rel=1e-6)
    assert kept.computed > 0.99


def test_potential_slosh_names_what_it_takes():
    with pytest.raises(CaseError, match="level must lie in"):
        run_case("slosh", {"fluid": "potential", "level": "1.95"})
    with pytest.raises(CaseError, match="one of"):
        run_case("slosh", {"level": "1.2"})


@pytest.mark.openfoam
def test_momentum_within_the_grid_error():
    found = errors(run_case("momentum", {"step": "0.02", "resolution": "180"}))
    # 4.7 % at n = 4 cells along an edge, from the operator alone: flux enters at cells' centres.
    assert 0.02 < found["imbalance"] < 0.06
    # Without the grid's error: second order in the amplitude, tilt 2e-3.
    assert found["imbalance_of_cells"] < 1e-3


@pytest.mark.openfoam
def test_momentum_of_the_walls_falls_with_the_square_of_the_grid():
    # n = 6 and 8 cells along an edge. With face values off the line between the cells it is 1.5.
    coarse, fine = (
        errors(run_case("momentum", {"step": "0.02", "resolution": str(cells)}))["imbalance"]
        for cells in (550, 1300)
    )
    assert np.log(coarse / fine) / np.log(8 / 6) > 1.7


def test_momentum_of_the_potential_liquid_within_the_error_of_its_triangles():
    coarse, fine = (
        errors(run_case("momentum", {"fluid": "potential", "resolution": str(rings)}))["imbalance"]
        for rings in (12, 16)
    )
    assert np.log(coarse / fine) / np.log(16 / 12) > 1.6  # second order
    assert fine < 2e-3


def operator_error(cells):
    """Of omega^2 R/g, by the discrete inertia of this grid alone: no step, no solver."""
    mesh = half_ball(cells)
    size = (2 * np.pi / 3 / cell_geometry(mesh, mesh.points).volume.sum()) ** (1 / 3)
    geometry = cell_geometry(mesh, size * mesh.points)
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    basis = np.linalg.svd(area[None])[2][1:].T
    inertia = basis.T @ (area[:, None] * NeumannLaplacian(mesh, geometry).trace() * area) @ basis
    weight = basis.T @ np.diag(area) @ basis
    return abs(float(eigh(weight, inertia, eigvals_only=True)[0]) / 1.560157 - 1)


@pytest.mark.openfoam
def test_slosh_frequency_within_grid_and_step_error():
    step, cells = 0.02, 550
    found = run_case("slosh", {"step": str(step), "resolution": str(cells)}).quantities[0]
    # backward lowers omega^2 by 2/3 (omega dt)^2; the grid's error is the operator's. A factor of
    # 1.5 for what both leave out: the solver's splitting, the fit over two periods.
    in_time = 2 / 3 * found.exact * GRAVITY / RADIUS * step**2
    assert found.error < 1.5 * (in_time + operator_error(cells))
    assert found.computed < found.exact
    assert found.error > 0.5 * in_time  # a solver of first order would be damped, not slower


@pytest.mark.openfoam
@pytest.mark.parametrize(("level", "most"), [(0.4, 0.025), (1.8, 0.06)])
def test_slosh_on_a_lens_and_below_a_small_surface(level, most):
    # Of second order, 1.1 and 3.4 over the square of 8 cells along an edge. With the cells' own
    # pressure on the walls of a lens 6.1 % were left, with a shell of even spacing at 1.8 10.1 %.
    assert errors(run_case("slosh", {"level": str(level)}))["lambda"] < most


def test_cylinder_of_polynomials_converges():
    """Without tension: with it, errors of either sign nearly cancel."""
    found = [
        errors(run_case("cylinder", {"tension": "0", "resolution": str(degree)}))["omega"]
        for degree in (6, 12)
    ]
    assert np.log2(found[0] / found[1]) > 1.9


@pytest.mark.parametrize(("tension", "exact"), [("0", 6.192920), ("100", 6.712671)])
def test_cylinder_by_default(tension, exact):
    found = run_case("cylinder", {"tension": tension}).quantities[0]
    assert found.exact == pytest.approx(exact, rel=1e-6)
    assert found.error < 5e-3


def test_tension_raises_the_frequency_as_it_should():
    """The membrane's share, apart from the liquid's error in the grid, which both have."""
    slack, tight = (
        run_case("cylinder", {"tension": str(tension), "resolution": "6"}).quantities[0]
        for tension in (0, 400)
    )
    share = tight.computed / slack.computed / (tight.exact / slack.exact)
    assert share == pytest.approx(1.0, abs=(1.841 / 6) ** 2 / 24 * 1.5)  # (k h)^2/24, bilinear
    assert tight.exact / slack.exact > 1.2


def test_prism_mesh_fills_the_cylinder():
    mesh = prism_mesh(700, 0.7)
    geometry = cell_geometry(mesh, mesh.points)
    assert geometry.volume.min() > 0
    assert geometry.volume.sum() == pytest.approx(0.7 * np.pi, rel=1e-12)
    top = geometry.face_area[mesh.diaphragm]
    assert top[:, 2].min() > 0
    assert top[:, 2].sum() == pytest.approx(np.pi, rel=1e-12)


@pytest.mark.parametrize("wrong", [{"mode": "1"}, {"mode": "1,0"}, {"depth": "0"}])
def test_cylinder_names_what_it_takes(wrong):
    with pytest.raises(CaseError, match=f"--{next(iter(wrong))}"):
        run_case("cylinder", wrong)


@pytest.mark.openfoam
def test_cylinder_with_openfoam_within_grid_and_step_error():
    step, cells = 0.04, 400
    found = run_case(
        "cylinder", {"fluid": "openfoam", "step": str(step), "resolution": str(cells)}
    ).quantities[0]
    mesh = prism_mesh(cells, 1.0)
    tank = Tank(tension=100.0, order=1, wave_number=jnp_zeros(1, 1)[0] / RADIUS, depth=1.0)
    top = RADIUS * mesh.points[mesh.patch_points]
    rows = LiquidInertia.of(
        NeumannLaplacian(mesh, cell_geometry(mesh, RADIUS * mesh.points)), top, DENSITY
    ).rows
    in_space = tank.surface(top, mesh.patch_faces).mode(tank.shape(top), rows)[0]
    # backward lowers omega by (omega dt)^2/3; its next order, and the solver's splitting, beside.
    angle = found.exact * step
    assert found.computed == pytest.approx(in_space * (1 - angle**2 / 3), rel=0.25 * angle**2 / 3)
    assert abs(in_space / found.exact - 1) < 0.01


@pytest.mark.parametrize("rim", ["free", "hinged", "clamped"])
def test_a_plate_on_the_liquid(rim):
    """Second order in the rings, a quarter at twice as many; 12 just resolve the rim's own bend."""
    coarse, fine = (
        errors(run_case("plate", {"rim": rim, "resolution": str(rings), "degree": "12"}))
        for rings in (12, 24)
    )
    assert fine["frequency"] < 0.4 * coarse["frequency"]
    assert fine["frequency"] < 0.01


def test_a_thin_plate_is_a_limp_cover():
    """Its stiffness adds kappa k^4/(rho g) to the square of the frequency, k R = 1.84 or so."""
    rubber = diaphragm("AF-E-332", 5e-4)
    cover = rubber.area_density / (DENSITY * RADIUS)
    limp = covered_eigenvalue(lateral_eigenvalue(1.0, 1), cover) * GRAVITY / RADIUS
    stiffness = rubber.bending_stiffness * (1.84 / RADIUS) ** 4 / (DENSITY * GRAVITY)
    assert stiffness < 1e-5
    assert (2.0 * np.pi * plate_frequency(rubber, "free")) ** 2 == pytest.approx(limp, rel=1e-5)


def test_what_a_plate_does_not_take():
    with pytest.raises(CaseError, match="--rim: must be one of free, hinged, clamped"):
        run_case("plate", {"rim": "glued"})


@pytest.mark.openfoam
def test_wall_layers_with_openfoam_take_what_theory_says():
    """A thick liquid, so that few cells do: the layer is 0.04 R, and wall cells 0.7 times that.

    What the theory leaves out is some such layers over R; the grid has four cells in a quarter of
    the circumference, whose error h^2 is some per cent as well. Backward's pi (omega dt)^3 is 1 %.
    """
    options = {"viscosity": 1e-3, "spacing": 0.03, "step": 0.02, "resolution": 900}
    found = errors(run_case("layers", {name: str(value) for name, value in options.items()}))
    assert found["loss"] < 0.2
    assert found["lambda"] < 0.02
