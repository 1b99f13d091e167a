"""Exact answers, on the grids and steps that a test can afford; tolerances from their orders."""

import numpy as np
import pytest
from scipy.linalg import eigh

from coupling.foam.added_mass import neumann_trace
from coupling.foam.geometry import cell_geometry
from coupling.foam.mesh import half_ball
from coupling.verify import CaseError, run_case
from coupling.verify.slosh import GRAVITY, RADIUS


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
        run_case(case, {"fluid": "potential"})


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
