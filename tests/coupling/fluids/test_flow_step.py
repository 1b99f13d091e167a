"""What is fixed in a flow's step: its volume, and the pressure that sliding points would cause."""

import numpy as np
import pytest

from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.gradients import wall_pressure
from coupling.finite_volume.mesh import half_ball
from coupling.fluids.openfoam.flow_step import FlowSettings, FlowStep
from coupling.ports import Cause, StepFailed

DENSITY = 1000.0


@pytest.fixture(scope="module")
def mesh():
    return half_ball(176)


@pytest.fixture(scope="module")
def geometry(mesh):
    return cell_geometry(mesh, mesh.points)


def step_of(mesh, sliding=None):
    return FlowStep(
        mesh=mesh, density=DENSITY, start=0.0, end=0.01, dt=0.01, previous_dt=0.0, sliding=sliding
    )


def closed_rate(mesh):
    """Rates of the fluxes through the diaphragm (F,) and all boundary faces (B,), of sum 0."""
    count = len(mesh.faces) - mesh.inner_faces
    rate = np.random.default_rng(0).normal(size=count)
    rate -= rate.mean()
    return rate[: mesh.diaphragm_faces], rate


def test_a_volume_that_is_not_kept_is_refused(mesh):
    step, settings = step_of(mesh), FlowSettings(closure=1e-12)
    step.refuse_open(np.array([1.0, -1.0 + 0.9e-12]), 1.0, settings)
    with pytest.raises(StepFailed, match=r"t = 0.01 s: .* volume by 1.1e-12 of it") as failure:
        step.refuse_open(np.array([1.0, -1.0 + 1.1e-12]), 1.0, settings)
    assert failure.value.cause is Cause.MESH


def test_pressure_on_the_walls_without_sliding_is_the_cells(mesh, geometry):
    rate, _ = closed_rate(mesh)
    cells = np.random.default_rng(1).normal(size=mesh.cells)
    wanted = DENSITY * wall_pressure(mesh, geometry, cells, rate)
    assert (step_of(mesh).wall_pressure(geometry, cells, rate) == wanted).all()


def test_a_liquid_whose_boundary_only_slides_feels_nothing(mesh, geometry):
    """The solver's answer to sliding, and sliding alone, is taken off to rounding."""
    on_patch, everywhere = closed_rate(mesh)
    step = step_of(mesh, everywhere).expected_at(geometry)
    answer = step.operator.pressure(everywhere)
    felt = step.wall_pressure(geometry, answer, on_patch)
    scale = np.abs(DENSITY * wall_pressure(mesh, geometry, answer, on_patch)).max()
    assert np.abs(felt).max() < 1e-12 * scale
    # So does inertia alone, which takes the same fluxes for the shell's faces.
    assert np.abs(step.inertial_pressure(geometry, on_patch)).max() < 1e-10 * scale
