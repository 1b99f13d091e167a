"""Topology of the liquid's mesh, as OpenFOAM asks for it."""

import numpy as np
import pytest

from coupling.finite_volume.blocks import graded
from coupling.finite_volume.corner_energy import corner_energy
from coupling.finite_volume.elastic_mesh import ElasticMesh, MeshFolds
from coupling.finite_volume.geometry import cell_geometry, fan_volume
from coupling.finite_volume.mesh import half_ball, shell_shares
from coupling.finite_volume.mesh_sizes import cells_above, cells_halved, cells_made


@pytest.fixture(params=[176, 650])
def mesh(request):
    return half_ball(request.param)


def test_owner_is_the_lower_cell_and_order_is_upper_triangular(mesh):
    inner = mesh.inner_faces
    owner, neighbour = mesh.owner[:inner], mesh.neighbour
    assert (owner < neighbour).all()
    order = owner * mesh.cells + neighbour
    assert (np.diff(order) > 0).all()


def test_every_cell_has_six_faces_and_every_point_is_used(mesh):
    count = np.bincount(np.concatenate([mesh.owner, mesh.neighbour]), minlength=mesh.cells)
    assert (count == 6).all()
    assert (np.unique(mesh.faces) == np.arange(len(mesh.points))).all()


def test_euler_characteristic_is_a_ball(mesh):
    assert len(mesh.points) - len(mesh.edges) + len(mesh.faces) - mesh.cells == 1


def test_boundary_faces_point_outwards(mesh):
    geometry = cell_geometry(mesh, mesh.points)
    assert (geometry.volume > 0).all()
    boundary = slice(mesh.inner_faces, None)
    reach = geometry.face_centre[boundary] - geometry.centre[mesh.owner[boundary]]
    assert (np.sum(reach * geometry.face_area[boundary], axis=1) > 0).all()
    inner = geometry.centre[mesh.neighbour] - geometry.centre[mesh.owner[: mesh.inner_faces]]
    assert (np.sum(inner * geometry.face_area[: mesh.inner_faces], axis=1) > 0).all()


def test_boundary_is_closed_and_its_patches_meet_at_the_rim(mesh):
    loops = mesh.faces[mesh.inner_faces :]
    directed = np.concatenate([loops[:, [k, (k + 1) % 4]] for k in range(4)])
    forward = {tuple(edge) for edge in directed.tolist()}
    assert len(forward) == len(directed)
    assert all((b, a) in forward for a, b in forward)
    rim = mesh.points[mesh.patch_points][mesh.rim]
    assert np.abs(rim[:, 2]).max() < 1e-12
    assert np.linalg.norm(rim, axis=1) == pytest.approx(1.0)
    assert mesh.diaphragm.stop == mesh.shell.start
    assert mesh.shell.stop == len(mesh.faces)


def test_too_few_cells_are_refused():
    with pytest.raises(ValueError, match="coarsest mesh has 16 cells, got 8"):
        half_ball(8)
    assert half_ball(352).cells == 176


def test_interior_follows_linearly():
    mesh = half_ball(176)
    elastic = ElasticMesh(mesh, 1.0)
    one, two = mesh.points + 0.05 * np.sin(3 * mesh.points), mesh.points * (1.0, 0.9, 1.1)
    follow = lambda goal: elastic.carried(mesh.points, goal) - mesh.points  # noqa: E731
    both = follow(one + two - mesh.points)
    assert np.abs(both - follow(one) - follow(two)).max() < 1e-12
    shift = np.array([0.1, 0.2, 0.3])
    assert np.abs(follow(mesh.points + shift) - shift).max() < 1e-12


def test_relaxed_mesh_is_valid_where_a_linear_one_folds():
    mesh = half_ball(176)
    elastic = ElasticMesh(mesh, 1.0)
    outline = mesh.points.copy()
    disc = mesh.patch_points
    height = -0.75 * (1 - np.sum(mesh.points[disc, :2] ** 2, axis=1))
    outline[disc, 2] += height
    boundary = mesh.faces[mesh.inner_faces :]
    size = fan_volume(outline[boundary]) / fan_volume(mesh.points[boundary])
    relaxed = elastic.relax(mesh.points, outline, size=size)
    assert cell_geometry(mesh, relaxed).volume.min() > 0
    assert (relaxed[elastic.boundary] == outline[elastic.boundary]).all()


@pytest.mark.parametrize("e", [0.0, 0.2])
def test_force_is_the_gradient_of_the_energy(e):
    mesh = half_ball(176)
    elastic, generator = ElasticMesh(mesh, 1.0), np.random.default_rng(2)
    # Valid for the energy itself, tangled for the one that stands for it.
    points = mesh.points + (0.01 if e == 0.0 else 0.2) * generator.standard_normal(
        (len(mesh.points), 3)
    )
    along, gradient = generator.standard_normal(points.shape), np.empty_like(points)

    def energy(at):
        return corner_energy(at, elastic.corners, elastic._inverse, 0.9, 0.5, e, gradient)

    step = 1e-6
    slope = (energy(points + step * along) - energy(points - step * along)) / (2.0 * step)
    assert np.isfinite(energy(points))
    # Central differences: rounding over the step and the step squared, 1e-10 and 1e-12 times how
    # fast the energy bends over e.
    assert np.sum(gradient * along) == pytest.approx(slope, rel=1e-6)


def test_tangled_mesh_comes_to_the_same_rest_as_a_valid_one():
    mesh = half_ball(176)
    elastic = ElasticMesh(mesh, 1.0)
    tangled = mesh.points.copy()
    inside = elastic.interior
    tangled[inside] = 0.3 * np.random.default_rng(1).standard_normal((len(inside), 3))
    assert cell_geometry(mesh, tangled).volume.min() < 0
    untangled = elastic.relax(tangled, mesh.points, size=1.0)
    assert cell_geometry(mesh, untangled).volume.min() > 0
    rest = elastic.relax(mesh.points, mesh.points, size=1.0)
    spacing = (0.5 * np.pi / len(inside)) ** (1 / 3)
    # Both come to TOLERANCE of how far from rest they began once valid: about a spacing.
    assert np.abs(untangled - rest).max() < 1e-2 * spacing


def test_impossible_boundary_is_refused():
    mesh = half_ball(176)
    outline = mesh.points.copy()
    outline[mesh.patch_points, 2] -= 2.0 * (1 - np.sum(mesh.points[mesh.patch_points, :2] ** 2, 1))
    for impossible in (outline, np.full_like(outline, np.nan)):
        with pytest.raises(MeshFolds):
            ElasticMesh(mesh, 1.0).relax(mesh.points, impossible, size=0.5)


@pytest.mark.parametrize(
    ("arc", "dense"), [(0.9, 1.0), (np.pi / 2, 1.0), (2.5, 0.613), (3.1, 0.145)]
)
def test_shells_points_crowd_towards_the_rim_of_a_small_patch(arc, dense):
    reach = np.linspace(0.0, 1.0, 1001)
    found = shell_shares(reach, arc)
    assert found[[0, -1]] == pytest.approx([0.0, 1.0], abs=1e-15)
    assert (np.diff(found) > 0).all()
    assert (found[-1] - found[-2]) * 1000 == pytest.approx(dense, abs=2e-3)


def test_steps_below_the_energys_rounding_are_not_halved(monkeypatch):
    # Of a motion of 1e-8 the energy, some 1e4, knows nothing; its gradient does.
    mesh = half_ball(1300)
    elastic = ElasticMesh(mesh, 1.0)
    start = boundary = mesh.points + 0.05 * np.sin(4 * mesh.points[:, [1, 2, 0]])
    for _ in range(4):
        start = elastic.relax(start, boundary, size=1.0)
    calls = []

    def counted(*given):
        calls.append(corner_energy(*given))
        return calls[-1]

    monkeypatch.setattr("coupling.finite_volume.elastic_mesh.corner_energy", counted)
    elastic.relax(start, start + 1e-8 * np.sin(4 * start[:, [1, 2, 0]]), size=1.0)
    assert 1 < len(calls) < 20  # one or two an iteration; a step halved to nothing takes 20 alone


def test_cells_are_graded_to_the_walls():
    """The cells at both walls are as low as asked, neighbours grow evenly, and all stay open."""
    spacing = 0.004
    mesh = half_ball(2100, spacing)
    geometry = cell_geometry(mesh, mesh.points)
    assert geometry.volume.min() > 0
    walls = slice(mesh.inner_faces, None)
    area = geometry.face_area[walls]
    normal = area / np.linalg.norm(area, axis=1)[:, None]
    reach = geometry.face_centre[walls] - geometry.centre[mesh.owner[walls]]
    height = 2.0 * np.sum(reach * normal, axis=1)
    # At most as high; a facet's sagitta in the middle, h^2/8 of cells pi/8 wide, stays below.
    assert height.max() < spacing
    assert height.min() > 0.3 * spacing
    assert half_ball(2100, 0.0).cells == cells_made(2100)
    assert mesh.cells == cells_made(2100, spacing)
    assert cells_halved(6000, spacing) < 6000 < cells_above(6000, spacing)


@pytest.mark.parametrize(("count", "first"), [(5, 1e-3), (3, 0.02), (12, 1e-4)])
def test_graded_levels_are_a_progression(count, first):
    levels = graded(count, first)
    length = np.diff(levels)
    assert levels[0] == 0.0
    assert levels[-1] == 1.0
    assert length[-1] == pytest.approx(first)
    ratio = length[:-1] / length[1:]
    assert ratio == pytest.approx(ratio[0])
    assert 1.0 < ratio[0] < 1.1 * count / (count - 1)  # ratios tend to 1 as the count grows
    assert length[0] < 1.1 / count
    assert np.diff(graded(count, 0.0)) == pytest.approx(1.0 / count)
    assert np.diff(graded(count, 1.0)) == pytest.approx(1.0 / count)
