"""The mesh that follows the diaphragm: its volume, and what it does when it gets bad."""

import numpy as np
import pytest

from cloth.shell.sphere import Sphere
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.mesh import half_ball
from coupling.ports import Cause, RunFailed


@pytest.fixture
def following():
    """Half a ball below a level disc, one step begun."""
    mesh = half_ball(176)
    following = FollowingMesh(mesh, Sphere(1.0))
    following.place(mesh.points[mesh.patch_points], mesh.points[mesh.shell_points])
    following.begin_step(None)
    return following


def tilted(following, size):
    """The disc tilted about y by ``size``, its rim at rest."""
    patch = following.patch.copy()
    patch[:, 2] += size * patch[:, 0] * (1 - np.sum(patch[:, :2] ** 2, axis=1))
    return following.close_volume(patch)


def test_volume_is_closed_as_the_solver_sums_it(following):
    patch = tilted(following, 0.3)
    swept = following.follow(patch, "now")
    assert np.abs(swept).max() > 1e-3
    assert abs(swept.sum()) < 1e-14
    following.accept_step()
    assert following.geometry.volume.sum() == pytest.approx(following.volume, rel=1e-12)


def test_a_sliding_shell_is_closed_too(following):
    turn = 0.1
    mesh = following.mesh
    turned = mesh.points[mesh.shell_points] @ np.array(
        [[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    following.begin_step(turned)
    patch = following.close_volume(following.patch)
    assert np.abs(patch - following.patch).max() > 1e-6
    assert abs(following.follow(patch, "now").sum()) < 1e-14


def test_later_iterations_follow_linearly(following):
    one, two = tilted(following, 0.1), tilted(following, 0.2)
    following.follow(one, "now")
    first = following.now.points
    following.follow(two, "now")
    second = following.now.points
    following.follow(0.5 * (one + two), "now")
    assert np.abs(following.now.points - 0.5 * (first + second)).max() < 1e-12


def test_a_folded_mesh_is_made_anew(following):
    inside = following._elastic.interior
    folded = following.points.copy()
    folded[inside] *= 1.6  # beyond the boundary: no relaxation can start there
    following.return_to(folded)
    following.begin_step(None)
    following.follow(following.close_volume(following.patch), "now")
    following.accept_step()
    assert following.geometry.volume.min() > 0
    assert following.non_orthogonality_max < 40.0


def test_a_boundary_without_any_mesh_ends_the_run(following):
    patch = following.patch.copy()
    patch[:, 2] -= 2.0 * (1 - np.sum(patch[:, :2] ** 2, axis=1))
    with pytest.raises(RunFailed, match="now: no valid mesh ") as failure:
        following.follow(patch, "now")
    assert failure.value.cause is Cause.MESH
