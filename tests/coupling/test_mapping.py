"""Linear maps between cloth and flow: what they must reproduce whatever the meshes."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from coupling.foam.mesh import half_ball
from coupling.mapping import Matching, moving_least_squares


@pytest.fixture(params=[8, 16])
def pair(request):
    """A cloth coarser or finer than the flow's patch, moulded on it, and their weights."""
    cloth, mesh = hemisphere(1.0, request.param), half_ball(540)
    disc = mesh.points[mesh.patch_points]
    reach = np.linalg.norm(disc, axis=1) * 0.45 * np.pi
    azimuth = np.arctan2(disc[:, 1], disc[:, 0])
    target = np.stack(
        [np.sin(reach) * np.cos(azimuth), np.sin(reach) * np.sin(azimuth), np.cos(reach)], axis=1
    )
    return cloth, target, moving_least_squares(cloth.points, target)


def test_rows_sum_to_one(pair):
    assert np.abs(pair[2].sum(axis=1) - 1).max() < 1e-12


def test_what_is_linear_in_the_tangent_plane_is_reproduced(pair):
    cloth, target, weights = pair
    off = weights @ cloth.points - target
    along = np.sum(off * target, axis=1)
    assert np.abs(off - along[:, None] * target).max() < 1e-10
    assert along.max() < 1e-10  # chords lie below the sphere
    assert along.min() > -0.06


def test_every_node_below_the_patch_receives_force(pair):
    cloth, target, weights = pair
    below = cloth.points[:, 2] > target[:, 2].min()
    assert (np.abs(weights[:, below]).max(axis=0) > 1e-6).all()


def test_rows_move_smoothly_with_their_target(pair):
    cloth, target, weights = pair
    turn = 1e-7
    moved = target @ np.array([[1.0, 0.0, -turn], [0.0, 1.0, 0.0], [turn, 0.0, 1.0]])
    change = np.abs(moving_least_squares(cloth.points, moved) - weights).max()
    assert change < 1e2 * turn  # a weight goes from 0 to 1 over a spacing, some 0.1


def test_matching_changes_nothing():
    values = np.arange(12.0).reshape(4, 3)
    matching = Matching()
    assert matching.begin_step(None, 0.1) is None
    assert matching.to_flow(values) is values
    assert matching.to_cloth(values) is values
    assert (matching.rows_to_cloth(values[None]) == values).all()
    assert (values + matching.beside(np.ones(5)) == values).all()
    assert matching.save() == {}
