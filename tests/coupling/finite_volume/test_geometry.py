"""Volumes as OpenFOAM sums them: closed, consistent with each other, and of second order."""

import geometry_reference as reference
import numpy as np
import pytest

from coupling.finite_volume.geometry import (
    cell_geometry,
    face_centres_and_areas,
    fan_volume,
    non_orthogonality,
    swept_volumes,
)
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.mesh_sizes import cells_halved, cells_made


def deformed(points):
    return points + 0.05 * np.sin(4 * points[:, [1, 2, 0]]) * (1.0, 0.5, 0.8)


def test_kernels_against_their_definitions():
    mesh = half_ball(700)
    old, new = mesh.points[mesh.faces], deformed(mesh.points)[mesh.faces]
    for got, wanted in zip(
        face_centres_and_areas(new), reference.face_centres_and_areas(new), strict=True
    ):
        np.testing.assert_allclose(got, wanted, atol=1e-15)
    np.testing.assert_allclose(
        swept_volumes(old, new), reference.swept_volumes(old, new), atol=1e-16
    )
    assert fan_volume(new) == pytest.approx(reference.fan_volume(new), rel=1e-13)
    got = cell_geometry(mesh, deformed(mesh.points))
    wanted = reference.cell_geometry(mesh, deformed(mesh.points))
    np.testing.assert_allclose(got.volume, wanted.volume, rtol=1e-12)
    np.testing.assert_allclose(got.centre, wanted.centre, atol=1e-14)


def test_square():
    corner = np.array([[0, 0, 1], [2, 0, 1], [2, 3, 1], [0, 3, 1]], float)[None]
    centre, area = face_centres_and_areas(corner)
    assert centre[0] == pytest.approx([1.0, 1.5, 1.0])
    assert area[0] == pytest.approx([0.0, 0.0, 6.0])


def test_swept_volume_of_a_box():
    corner = np.array([[0, 0, 1], [2, 0, 1], [2, 3, 1], [0, 3, 1]], float)[None]
    assert swept_volumes(corner, corner + np.array([0.3, -0.2, 0.5])) == pytest.approx(
        3.0, rel=1e-14
    )
    assert swept_volumes(corner, corner) == pytest.approx(0.0, abs=1e-15)


def test_swept_volumes_add_up_to_the_change_of_volume():
    mesh = half_ball(400)
    boundary = mesh.faces[mesh.inner_faces :]
    old, new = mesh.points, deformed(mesh.points)
    swept = swept_volumes(old[boundary], new[boundary]).sum()
    change = fan_volume(new[boundary]) - fan_volume(old[boundary])
    assert abs(change) > 1e-4
    assert swept == pytest.approx(change, abs=1e-13)


def test_swept_volume_there_and_back_is_none():
    mesh = half_ball(400)
    boundary = mesh.faces[mesh.inner_faces :]
    old, new = mesh.points[boundary], deformed(mesh.points)[boundary]
    assert np.abs(swept_volumes(old, new) + swept_volumes(new, old)).max() < 1e-15


def test_cells_are_closed_and_fill_the_boundary():
    mesh = half_ball(700)
    geometry = cell_geometry(mesh, deformed(mesh.points))
    outward = np.zeros((mesh.cells, 3))
    np.add.at(outward, mesh.owner, geometry.face_area)
    np.add.at(outward, mesh.neighbour, -geometry.face_area[: mesh.inner_faces])
    assert np.abs(outward).max() < 1e-15
    # By the divergence theorem on the boundary alone; OpenFOAM's two fans differ by the warp.
    boundary = slice(mesh.inner_faces, None)
    centre, area = geometry.face_centre[boundary], geometry.face_area[boundary]
    assert geometry.volume.sum() == pytest.approx(np.sum(centre * area) / 3, rel=1e-12)
    assert (geometry.volume > 0).all()


def test_volume_is_of_second_order():
    # n = 4, 8, 16 cells along an edge: the error falls as c n^-2 + O(n^-4).
    meshes = [half_ball(size) for size in (180, 1550, 12300)]
    errors = [1 - cell_geometry(m, m.points).volume.sum() / (2 * np.pi / 3) for m in meshes]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders[-1] == pytest.approx(2.0, abs=0.06)
    # A facet of width h = pi/(2 n) lies h^2/12 per direction below the sphere in the mean, which
    # costs h^2/2 of the volume; equiangular facets are a little narrower at the cube's corners.
    assert errors[-1] == pytest.approx((np.pi / 2 / 16) ** 2 / 2, rel=0.2)


def test_centre_of_a_half_ball_is_of_second_order():
    errors, faces = [], []
    for size in (90, 600, 4200):
        mesh = half_ball(size)
        geometry = cell_geometry(mesh, mesh.points)
        centre = geometry.volume @ geometry.centre / geometry.volume.sum()
        assert np.abs(centre[:2]).max() < 1e-14
        errors.append(abs(centre[2] + 3 / 8))
        faces.append(mesh.diaphragm_faces)
    order = np.log(errors[0] / errors[-1]) / np.log(np.sqrt(faces[-1] / faces[0]))
    assert order == pytest.approx(2.0, abs=0.2)


def test_non_orthogonality_of_a_slanted_pair():
    # All inner faces of a sheared ball: bounds only; the cube's central faces are exact.
    mesh = half_ball(400)
    angle = non_orthogonality(mesh, cell_geometry(mesh, mesh.points))
    assert angle.shape == (mesh.inner_faces,)
    assert 0 <= angle.min() < 1.0
    assert angle.max() < 45.0
    sheared = mesh.points.copy()
    sheared[:, 0] += np.tan(np.radians(50)) * mesh.points[:, 2]
    assert non_orthogonality(mesh, cell_geometry(mesh, sheared)).max() > 50.0


def test_the_cells_of_a_mesh_are_known_before_it_is_made():
    for asked in (64, 176, 650, 1215, 1216, 2000, 2300, 9727):
        assert cells_made(asked) == half_ball(asked).cells
    # Half of 1216 lies nearer to 540 than to 176, of 2300 to 1216, of 4320 to 2300.
    assert [cells_halved(asked) for asked in (1300, 2400, 5000)] == [540, 1216, 2300]
