"""Forces of the flow's pressure: the transpose of the swept volume, to rounding."""

import numpy as np
import pytest

from coupling.finite_volume.geometry import swept_volumes
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.swept import cross, pressure_force, swept_gradient


@pytest.fixture(scope="module")
def patch():
    """Points (p, 3) and faces (F, 4) of a curved patch with warped faces."""
    mesh = half_ball(400)
    points = mesh.points[mesh.patch_points] * (0.4, 0.5, 0.3)
    return points + 0.01 * np.sin(7 * points[:, [1, 2, 0]]), mesh.patch_faces


def test_cross_product():
    a, b = np.random.default_rng(0).normal(size=(2, 5, 4, 3))
    assert np.abs(cross(a, b) - np.cross(a, b)).max() < 1e-15


def test_force_is_the_transpose_of_the_swept_volume(patch):
    points, faces = patch
    generator = np.random.default_rng(1)
    pressure, shift = generator.normal(size=len(faces)), generator.normal(size=points.shape)
    swept = np.einsum("fkx,fkx->f", swept_gradient(points[faces]), shift[faces])
    work = np.sum(pressure_force(points, faces, pressure) * shift)
    assert work == pytest.approx(pressure @ swept, rel=1e-12)


def test_force_of_one_pressure_is_that_of_the_rim_alone(patch):
    # The area of a patch depends on its rim only: a uniform pressure on a closed shape adds to 0.
    mesh = half_ball(400)
    boundary = mesh.faces[mesh.inner_faces :]
    force = pressure_force(mesh.points, boundary, np.ones(len(boundary)))
    assert np.abs(force.sum(axis=0)).max() < 1e-13
    assert np.abs(np.cross(mesh.points, force).sum(axis=0)).max() < 1e-13


def test_virtual_work_with_its_order(patch):
    # sum(F dx) = sum(p dV) for small dx; central differences err by the square of dx but for the
    # apex, whose motion on warped faces is taken as the mean of the corners'.
    points, faces = patch
    shift = np.cos(5 * points)
    exact = np.einsum("fkx,fkx->f", swept_gradient(points[faces]), shift[faces])

    def found(size):
        corner, moved = points[faces], size * shift[faces]
        return swept_volumes(corner - moved, corner + moved) / (2 * size)

    errors = [np.abs(found(size) - exact).max() for size in (4e-2, 2e-2, 1e-2)]
    area = np.linalg.norm(swept_gradient(points[faces]).sum(axis=1), axis=1).max()
    assert np.log2((errors[0] - errors[2]) / (errors[1] - errors[2])) > np.log2(4.9)  # 5 if squares
    assert errors[2] < 2e-3 * area


def test_parallelograms_are_exact():
    # The fan's apex is the mean of the corners, and stays it to first order under any lift.
    corner = np.array([[0, 0, 0], [2, 0, 0], [2.5, 1.5, 0], [0.5, 1.5, 0]], float)[None]
    gradient = swept_gradient(corner)
    assert gradient.sum(axis=(0, 1)) == pytest.approx([0.0, 0.0, 3.0], abs=1e-14)
    shift = np.random.default_rng(2).normal(size=corner.shape)
    small = 1e-5  # an error of its square, and of rounding over it
    found = swept_volumes(corner - small * shift, corner + small * shift)[0] / (2 * small)
    assert found == pytest.approx(np.sum(gradient * shift), rel=1e-8)
