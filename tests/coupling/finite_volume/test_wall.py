"""What the flow does along its walls, of a uniform velocity in a half ball."""

from __future__ import annotations

import numpy as np
import pytest

from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.wall import cell_distance, wall_flow

RADIUS, SPEED, VISCOSITY = 0.5, 0.3, 1e-3
MESH = half_ball(2000)
GEOMETRY = cell_geometry(MESH, RADIUS * MESH.points)
ACROSS = np.tile([SPEED, 0.0, 0.0], (MESH.cells, 1))
AT_REST = np.zeros((MESH.diaphragm_faces, 3))


def test_slip_of_a_uniform_stream_is_that_along_sphere_and_disc():
    """u^2 times int (1 - n_x^2) dS: 4 pi R^2/3 of the half sphere and pi R^2 of the disc."""
    found = wall_flow(MESH, GEOMETRY, ACROSS, AT_REST, viscosity=VISCOSITY)
    exact = SPEED**2 * np.pi * RADIUS**2 * (4.0 / 3.0 + 1.0)
    spacing = np.sqrt(np.pi / MESH.diaphragm_faces)  # of inscribed facets, over R
    assert found.slip == pytest.approx(exact, rel=spacing**2)


def test_diaphragm_that_moves_along_feels_nothing():
    along = np.tile([SPEED, 0.0, 0.0], (MESH.diaphragm_faces, 1))
    found = wall_flow(MESH, GEOMETRY, ACROSS, along, viscosity=VISCOSITY)
    at_rest = wall_flow(MESH, GEOMETRY, ACROSS, AT_REST, viscosity=VISCOSITY)
    assert np.abs(found.traction).max() < 1e-12 * at_rest.traction.max()
    assert at_rest.slip - found.slip == pytest.approx(SPEED**2 * np.pi * RADIUS**2, rel=0.02)


def test_stress_is_viscosity_times_speed_over_the_half_cell():
    """Along the flat diaphragm mu u/d, towards it twice that; d is half a cell's height."""
    patch = MESH.diaphragm
    depth = -GEOMETRY.centre[MESH.owner[patch], 2]
    along = wall_flow(MESH, GEOMETRY, ACROSS, AT_REST, viscosity=VISCOSITY)
    assert along.traction == pytest.approx(VISCOSITY * SPEED / depth, rel=1e-9)
    towards = wall_flow(MESH, GEOMETRY, ACROSS[:, [1, 2, 0]], AT_REST, viscosity=VISCOSITY)
    assert towards.traction == pytest.approx(2.0 * VISCOSITY * SPEED / depth, rel=1e-9)
    assert 0.5 * depth.min() < cell_distance(MESH, GEOMETRY) < 2.0 * depth.max()
