"""Exact answers, on the grids and steps that a test can afford; tolerances from their orders."""

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import jnp_zeros

from coupling.foam.added_mass import neumann_trace
from coupling.foam.geometry import cell_geometry
from coupling.foam.mesh import half_ball
from coupling.verify import CaseError, run_case
from coupling.verify.cylinder import Tank
from coupling.verify.free_surface import LUMPED
from coupling.verify.potential_slosh import added_mass
from coupling.verify.prism import prism_mesh
from coupling.verify.slosh import DENSITY, EIGENVALUES, GRAVITY, RADIUS
from coupling.verify.sloshing_modes import lateral_eigenvalue


def errors(result):
    return {quantity.name: quantity.error for quantity in result.quantities}


def test_equation_46():
    assert max(errors(run_case("eq46")).values()) < 5e-4  # printed with four digits


def test_numbers():
    found = errors(run_case("numbers"))
    assert found["bond_min"] < 0.05 / 2.3 / 2 + 1e-3  # printed as 2300
    assert found["bond_max"] < 5e-4
    assert found["weber_max"] < 5e-3  # printed with three digits


@pytest.mark.openfoam
def test_rigid_body_limit():
    found = errors(run_case("rigid"))
    # No motion, no pressure: rounding alone. The contract's 1e-6 is met by far.
    assert found["dynamic_pressure"] < 1e-12
    assert found["force"] < 1e-12


@pytest.mark.openfoam
@pytest.mark.parametrize("case", ["rigid", "momentum", "slosh"])
def test_other_fluids_are_refused(case):
    with pytest.raises(CaseError, match="fluid"):
        run_case(case, {"fluid": "datum"})


def test_lateral_modes_are_those_of_the_literature():
    for (level, mode), printed in EIGENVALUES.items():
        digits = 1e-6 if printed == 1.560157 else 1e-4  # half of the last one printed, and rounding
        assert lateral_eigenvalue(level, mode) == pytest.approx(printed, abs=0.51 * digits)


@pytest.mark.parametrize(("level", "mode", "order"), [(0.4, 1, 1.6), (1.0, 2, 1.6), (1.8, 1, 1.6)])
def test_potential_slosh_converges(level, mode, order):
    # n = 6 and 12 cells along the square's edge: 132 and 528 faces.
    found = [
        errors(run_case("slosh", {
            "fluid": "potential", "level": str(level), "mode": str(mode), "resolution": str(faces),
        }))["lambda"]
        for faces in (132, 528)
    ]  # fmt: skip
    assert np.log2(found[0] / found[1]) > order
    # 2200 faces are the default: n = 24, at that order from here.
    assert found[1] / 2**order < {1: 2e-3, 2: 1e-2}[mode]


def test_potential_slosh_in_time_keeps_its_energy():
    step, faces = 0.01, 132
    options = {"fluid": "potential", "resolution": str(faces)}
    in_space = run_case("slosh", options).quantities[0].computed
    moving, kept = run_case("slosh", options | {"step": str(step)}).quantities
    angle = np.sqrt(in_space * GRAVITY / RADIUS) * step
    # backward lowers omega^2 by 2/3 (omega dt)^2. The share of gravity that acts on the nodes sees
    # heights that are (k h)^2/8 above the means over faces, k of the mode and h^2 their area.
    own = LUMPED * (jnp_zeros(1, 1)[0] ** 2 * np.pi / faces) / 4
    wanted = in_space * (1 - 2 / 3 * angle**2 + own)
    assert moving.computed == pytest.approx(wanted, rel=0.2 * own + angle**4)
    lost = 20 * np.pi * angle**3  # in twenty periods; a third more for the higher modes
    assert 1 - 1.5 * lost < kept.computed < 1 - 0.9 * lost


def test_potential_slosh_names_what_it_takes():
    with pytest.raises(CaseError, match="level must lie in"):
        run_case("slosh", {"fluid": "potential", "level": "1.95"})
    with pytest.raises(CaseError, match="one of"):
        run_case("slosh", {"level": "1.2"})


@pytest.mark.openfoam
def test_momentum_within_the_grid_error():
    found = errors(run_case("momentum", {"step": "0.02", "resolution": "180"}))
    # 4.8 % at n = 4 cells along an edge, from the operator alone: flux enters at cells' centres.
    assert 0.02 < found["imbalance"] < 0.06
    # Without the grid's error: second order in the amplitude, tilt 2e-3.
    assert found["imbalance_of_cells"] < 1e-3


def operator_error(cells):
    """Of omega^2 R/g, by the discrete added mass of this grid alone: no step, no solver."""
    mesh = half_ball(cells)
    size = (2 * np.pi / 3 / cell_geometry(mesh, mesh.points).volume.sum()) ** (1 / 3)
    geometry = cell_geometry(mesh, size * mesh.points)
    area = np.linalg.norm(geometry.face_area[mesh.diaphragm], axis=1)
    basis = np.linalg.svd(area[None])[2][1:].T
    inertia = basis.T @ (area[:, None] * neumann_trace(mesh, geometry) * area) @ basis
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


def test_cylinder_of_panels_converges():
    # n = 6 and 10 cells along the square's edge: 132 and 340 faces on the surface.
    found = [
        errors(run_case("cylinder", {"resolution": str(faces)}))["omega"] for faces in (132, 340)
    ]
    order = np.log(found[0] / found[1]) / np.log(10 / 6)
    assert order > 1.6
    assert found[1] * (10 / 12) ** order < 5e-3  # 600 faces are the default: n = 12


def test_tension_raises_the_frequency_as_it_should():
    """The membrane's share, apart from the liquid's error in the grid, which both have."""
    slack, tight = (
        run_case("cylinder", {"tension": str(tension), "resolution": "132"}).quantities[0]
        for tension in (0, 400)
    )
    share = tight.computed / slack.computed / (tight.exact / slack.exact)
    assert share == pytest.approx(1.0, abs=(1.841 / 6) ** 2 / 24 * 1.5)  # (k h)^2/24, bilinear
    assert tight.exact / slack.exact > 1.2


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
    trace = neumann_trace(mesh, cell_geometry(mesh, RADIUS * mesh.points))
    rows = added_mass(top, mesh.patch_faces, trace, DENSITY)
    in_space = tank.surface(top, mesh.patch_faces).mode(tank.shape(top), rows)
    # backward lowers omega by (omega dt)^2/3; its next order, and the solver's splitting, beside.
    angle = found.exact * step
    assert found.computed == pytest.approx(in_space * (1 - angle**2 / 3), rel=0.25 * angle**2 / 3)
    assert abs(in_space / found.exact - 1) < 0.01
