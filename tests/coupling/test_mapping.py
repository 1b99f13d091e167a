"""The map between diaphragm and flow: what its rows promise, to rounding."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from coupling.foam.mesh import ball, half_ball
from coupling.mapping import Matching, MovingLeastSquares

RADIUS = 0.4445


@pytest.fixture(
    params=[(ball, 8), (ball, 16), (half_ball, 8)], ids=lambda p: f"{p[0].__name__}{p[1]}"
)
def pair(request):
    """A cloth finer or coarser than the flow's patch, and their map."""
    topology, rings = request.param
    cloth, mesh = hemisphere(RADIUS, rings), topology(700)
    target = RADIUS * mesh.moulded
    mapping = MovingLeastSquares(cloth.points, target, source_rim=cloth.fixed, target_rim=mesh.rim)
    return cloth, mesh, target, mapping


def test_rows_sum_to_one(pair):
    mapping = pair[3]
    assert np.abs(mapping.weights.sum(axis=1) - 1).max() < 1e-12


def test_linear_fields_are_reproduced(pair):
    cloth, mesh, target, mapping = pair
    slope = np.array([[0.3, -1.0, 2.0], [0.5, 0.1, -0.7], [1.0, 2.0, 3.0]])
    found = mapping.to_flow(cloth.points @ slope.T + 0.2)
    error = np.abs(found - (target @ slope.T + 0.2))
    assert error[~mesh.rim].max() < 1e-10  # to rounding, the support is normalised
    # Rim rows see the rim's nodes alone, which span a plane: what is linear there is reproduced.
    assert error[mesh.rim].max() < 1e-10


def test_force_and_moment_are_conserved(pair):
    cloth, _, target, mapping = pair
    force = np.random.default_rng(1).normal(size=target.shape)
    nodal = mapping.to_cloth(force)
    assert np.abs(nodal.sum(axis=0) - force.sum(axis=0)).max() < 1e-10
    # The moment about the points as mapped: x_flow = N x_cloth, in a deformed shape as well.
    nodes = cloth.points * (1.0, 0.9, 0.5) + 0.01 * np.sin(9 * cloth.points)
    mapped = mapping.to_flow(nodes)
    found = np.cross(nodes, nodal).sum(axis=0)
    assert np.abs(found - np.cross(mapped, force).sum(axis=0)).max() < 1e-10


def test_work_is_conserved(pair):
    cloth, _, target, mapping = pair
    generator = np.random.default_rng(2)
    force, nodes = generator.normal(size=target.shape), generator.normal(size=cloth.points.shape)
    work = np.sum(force * mapping.to_flow(nodes))
    assert np.sum(mapping.to_cloth(force) * nodes) == pytest.approx(work, rel=1e-11, abs=1e-10)


def test_every_node_receives_force(pair):
    cloth, _, _, mapping = pair
    assert (np.abs(mapping.weights[:, ~cloth.fixed]).max(axis=0) > 1e-6).all()


def test_rim_maps_to_rim_only(pair):
    cloth, mesh, _, mapping = pair
    assert np.abs(mapping.weights[np.ix_(mesh.rim, ~cloth.fixed)]).max() == 0.0


def test_rows_map_like_forces(pair):
    _, _, target, mapping = pair
    rows = np.random.default_rng(3).normal(size=(2, *target.shape))
    expected = np.stack([mapping.to_cloth(row) for row in rows])
    assert np.abs(mapping.rows_to_cloth(rows) - expected).max() < 1e-12


def test_matching_changes_nothing():
    values = np.arange(12.0).reshape(4, 3)
    matching = Matching()
    assert matching.to_flow(values) is values
    assert matching.to_cloth(values) is values
    assert (matching.rows_to_cloth(values[None]) == values).all()
