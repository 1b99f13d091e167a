"""Linear maps between cloth and flow: what they must reproduce whatever the meshes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import null_space
from scipy.sparse import csr_array

from cloth.mesh import hemisphere
from coupling.finite_volume.mesh import half_ball
from coupling.interface.mapping import Matching
from coupling.interface.weights import (
    Sources,
    Support,
    least_norm_weights,
    moving_least_squares,
    moving_quadratics,
)

NARROW, WIDE = Support(reach=1.3, least=12), Support(reach=1.8, least=20)


def plain(source, target):
    """Weights of first order."""
    return moving_least_squares(Sources(source).beside(target, NARROW), NARROW)


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
    return cloth, target, plain(cloth.points, target)


def test_weights_against_their_definition():
    """One row by a general solve: of all weights that satisfy the conditions, the least."""
    cloth, target = hemisphere(1.0, 8).points, np.array([[0.1, 0.3, 0.0], [0.6, 0.5, 0.0]])
    target[:, 2] = np.sqrt(1.0 - np.sum(target**2, axis=1))
    distance = np.linalg.norm(cloth - target[:, None], axis=2)
    near = np.argsort(distance, axis=1)[:, :20]
    distance, radius = np.take_along_axis(distance, near, axis=1), np.array([0.4, 0.5])
    weights = np.zeros((2, len(cloth)))
    least_norm_weights(cloth, target, near, distance, radius, weights)
    for row, at, nodes, far, reach in zip(weights, target, near, distance, radius, strict=True):
        share = np.clip(1.0 - far / reach, 0.0, None)
        kernel = np.where(share > 0.0, share**2 + 1e-6, 0.0)
        conditions = np.column_stack([np.ones(20), (cloth[nodes] - at) @ null_space(at[None])])
        root = np.sqrt(kernel)
        least = np.linalg.lstsq((root[:, None] * conditions).T, [1.0, 0.0, 0.0])[0]
        np.testing.assert_allclose(row[nodes], root * least, atol=1e-12)
        assert (row != 0.0).sum() == (kernel > 0.0).sum()


def test_rows_sum_to_one(pair):
    assert np.abs(pair[2].sum(axis=1) - 1).max() < 1e-12


def test_what_is_linear_in_the_tangent_plane_is_reproduced(pair):
    cloth, target, weights = pair
    off = weights @ cloth.points - target
    along = np.sum(off * target, axis=1)
    assert np.abs(off - along[:, None] * target).max() < 1e-10
    assert along.max() < 1e-10  # chords lie below the sphere
    assert along.min() > -0.06


def test_quadratics_in_the_tangent_plane_are_reproduced_where_asked(pair):
    cloth, target, plain = pair
    weights = moving_quadratics(Sources(cloth.points).beside(target, WIDE), WIDE)
    across, along = np.zeros_like(target), np.zeros_like(target)
    across[:, 0] = 1.0
    across -= np.sum(across * target, axis=1)[:, None] * target
    across /= np.linalg.norm(across, axis=1)[:, None]
    along = np.cross(target, across)
    for row, averages, at, u, v in zip(weights, plain, target, across, along, strict=True):
        x, y = (cloth.points - at) @ u, (cloth.points - at) @ v
        for values in (x, y, x * x, x * y, y * y):
            assert abs(row @ values) < 1e-10
        assert averages @ (x * x + y * y) > 1e-3  # a mean over the support
    assert weights.sum(axis=1) == pytest.approx(np.ones(len(target)), abs=1e-12)


@pytest.mark.parametrize("weights", [moving_least_squares, moving_quadratics])
def test_no_source_within_a_support_is_missed(pair, weights):
    """Rows from as many sources as are looked for at first, and from all that a support allows."""
    cloth, target, _ = pair
    few = Sources(cloth.points).beside(target, WIDE)
    distance = np.linalg.norm(cloth.points - target[:, None], axis=2)
    near = np.argsort(distance, axis=1)[:, : WIDE.most]
    every = replace(few, near=near, distance=np.take_along_axis(distance, near, axis=1))
    assert few.near.shape[1] <= near.shape[1]  # 28 of 80 where the cloth is the coarser one
    assert weights(few, WIDE) == pytest.approx(weights(every, WIDE), abs=1e-12)


def test_every_node_below_the_patch_receives_force(pair):
    cloth, target, weights = pair
    below = cloth.points[:, 2] > target[:, 2].min()
    assert (np.abs(weights[:, below]).max(axis=0) > 1e-6).all()


def test_rows_move_smoothly_with_their_target(pair):
    cloth, target, weights = pair
    turn = 1e-7
    moved = target @ np.array([[1.0, 0.0, -turn], [0.0, 1.0, 0.0], [turn, 0.0, 1.0]])
    change = np.abs(plain(cloth.points, moved) - weights).max()
    assert change < 1e2 * turn  # a weight goes from 0 to 1 over a spacing, some 0.1


def test_matching_changes_nothing():
    values = np.arange(12.0).reshape(4, 3)
    matching = Matching()
    assert matching.begin_step(None, 0.1, np.zeros((3, 3))) is matching
    assert matching.shell is None
    assert matching.to_flow(values) is values
    assert matching.to_cloth(values) is values
    assert (matching.rows_to_cloth(csr_array(values.reshape(1, -1))) == values).all()
    assert matching.save() == {}
