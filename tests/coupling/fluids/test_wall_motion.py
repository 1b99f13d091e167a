"""The walls' own motion, without what their points slide along."""

import numpy as np
import pytest

from cloth.shell.sphere import Sphere
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.swept import pressure_force
from coupling.fluids.openfoam.wall_motion import centre_velocity, sliding_walls
from coupling.ports import InterfaceMotion

DT = 0.01
MESH = half_ball(176)


@pytest.fixture
def moved():
    """A mesh whose patch has swung and whose shell has turned, and what its faces sweep."""
    following = FollowingMesh(MESH, Sphere(1.0))
    patch, shell = MESH.points[MESH.patch_points], MESH.points[MESH.shell_points]
    following.place(patch, shell)
    following.begin_step(shell @ [[0.995, 0.1, 0.0], [-0.1, 0.995, 0.0], [0.0, 0.0, 1.0]])
    swung = patch.copy()
    swung[:, 2] += 0.05 * patch[:, 0] * (1 - np.sum(patch[:, :2] ** 2, axis=1))
    swept = following.follow(following.close_volume(swung), "now")
    return following, swept


def walls(moved, still, inertial=None, least=1e-10):
    following, swept = moved
    motion = InterfaceMotion(
        still=still, inertial=still if inertial is None else inertial, b=2 * DT / 3
    )
    return sliding_walls(
        MESH, following.now, motion,
        of_points=centre_velocity(MESH, following.committed, following.now, DT),
        swept=swept / DT, least=least,
    )  # fmt: skip


def normals(following):
    area = following.now.geometry.face_area[MESH.inner_faces :]
    size = np.linalg.norm(area, axis=1)
    return area / size[:, None], size


def test_a_sheet_at_rest_drives_nothing_however_its_points_slide(moved):
    following, swept = moved
    found = walls(moved, following.now.patch)
    scale = np.abs(swept).max() / DT
    assert np.abs(found.flux).max() < 1e-12 * scale
    assert np.abs(found.rate).max() < 1e-12 * scale / DT
    normal, size = normals(following)
    through = np.einsum("fx,fx->f", found.slide, normal) * size
    assert np.abs(through - swept / DT).max() < 1e-12 * scale
    aside = centre_velocity(MESH, following.committed, following.now, DT) - found.slide
    aside -= np.einsum("fx,fx->f", aside, normal)[:, None] * normal
    assert np.abs(aside).max() < 1e-12


def test_fluxes_are_the_sheets_own_and_do_the_work_of_its_forces(moved):
    following, swept = moved
    points = following.now.patch
    velocity = np.zeros_like(points)
    velocity[:, 2] = points[:, 0] * (1 - np.sum(points[:, :2] ** 2, axis=1))
    velocity[MESH.rim] = 0.0
    found = walls(moved, points - velocity * 2 * DT / 3)
    pressure = np.random.default_rng(0).normal(size=MESH.diaphragm_faces)
    work = np.sum(pressure_force(points, MESH.patch_faces, pressure) * velocity)
    # The even rise that closes the volume is by the swing's asymmetry, small here.
    assert pressure @ found.flux == pytest.approx(work, rel=0.02)
    assert abs(found.flux.sum()) < 1e-13
    normal, size = normals(following)
    kept = swept / DT - np.einsum("fx,fx->f", found.slide, normal) * size
    assert kept[: MESH.diaphragm_faces] == pytest.approx(found.flux, abs=1e-13)
    assert np.abs(kept[MESH.diaphragm_faces :]).max() < 1e-13  # the shell stands
    assert abs(kept.sum()) < 1e-13


def test_rates_are_those_of_the_sheets_acceleration(moved):
    following, _ = moved
    points = following.now.patch
    lifted = points + np.array([0.0, 0.0, 1e-3])
    found = walls(moved, points, inertial=lifted)
    area = following.now.geometry.face_area[MESH.diaphragm]
    # Fans and quadrilaterals have the same area; 1e-3 over (2 dt/3)^2 downwards.
    assert found.rate == pytest.approx(-area[:, 2] * 1e-3 / (2 * DT / 3) ** 2, rel=1e-9)


def test_a_slide_of_rounding_is_none(moved):
    assert (walls(moved, moved[0].now.patch, least=1e3).slide == 0.0).all()
