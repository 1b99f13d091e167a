"""The flow's boundary on a sheet at rest, from nearly empty to nearly full."""

from types import SimpleNamespace

import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere, level_of_fill_fraction
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.geometry import face_centres_and_areas
from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.swept import cross, pressure_force, swept_gradient, swept_rows
from coupling.interface.creases import give_way, least_sine
from coupling.interface.free_patch import FreePatch
from coupling.interface.liquid_shape import volume_below
from coupling.interface.patch_settings import PatchSettings
from coupling.ports import Cause, StepFailed

RADIUS = 0.4445
SHELL = Sphere(RADIUS)
FILLS = [0.1, 0.2, 0.3, 0.5, 0.8, 0.9, 0.95]


def patch_map(mesh, sheet, settings=None) -> FreePatch:
    moulded = sheet.reference / RADIUS
    return FreePatch(mesh, sheet, shell=SHELL, moulded=moulded, settings=settings)


def at_rest(sheet, fill):
    """The sheet without stiffness: level, the rest of it on the shell."""
    level = level_of_fill_fraction(fill) - 1.0
    x = sheet.reference / RADIUS
    polar = np.arccos(np.clip(x[:, 2], -1, 1))
    edge = np.arccos(abs(level))
    if abs(level) < 1e-3:
        edge = 0.5 * np.pi
    across = np.linalg.norm(x[:, :2], axis=1)
    reach = np.where(polar < edge, np.sin(edge) * polar / edge, across)
    x[:, :2] *= (reach / np.maximum(across, 1e-12))[:, None]
    x[:, 2] = np.where(polar < edge, level, np.sign(level) * x[:, 2])
    x[sheet.fixed] = sheet.reference[sheet.fixed] / RADIUS
    still = np.zeros_like(x)
    return SimpleNamespace(position=RADIUS * x, velocity=still, volume=fill * SHELL.volume)


@pytest.fixture(scope="module")
def sheet():
    """What the map needs of a diaphragm."""
    moulded = hemisphere(RADIUS, 16)
    return SimpleNamespace(
        reference=moulded.points, triangles=moulded.triangles, fixed=moulded.fixed
    )


@pytest.fixture(scope="module")
def mesh():
    return half_ball(540)


@pytest.fixture(scope="module", params=FILLS)
def fitted(request, sheet, mesh):
    """Map, state, patch and shell at a fill fraction."""
    state = at_rest(sheet, request.param)
    mapping = patch_map(mesh, sheet)
    placed = mapping.begin_step(state, 0.0, state.position)
    return mapping, state, placed.to_flow(state.position), placed.shell


def test_mesh_is_valid_at_every_fill(sheet, mesh, fitted):
    _, state, patch, shell = fitted
    following = FollowingMesh(mesh, SHELL)
    following.place(patch, shell)
    assert following.geometry.volume.min() > 0
    assert following.non_orthogonality_max < 65.0  # what OpenFOAM's own checkMesh calls no trouble
    below = volume_below(state.position, sheet.triangles, SHELL)
    assert following.volume == pytest.approx(below, rel=1e-11)


def test_rim_and_shell_lie_on_one_sphere(mesh, fitted):
    _, _, patch, shell = fitted
    size = np.linalg.norm(np.concatenate([patch[mesh.rim], shell]), axis=1) / RADIUS
    assert size == pytest.approx(size[0])
    assert 0.99 < size[0] < 1.05  # an inscribed polyhedron stands out a little


def test_patch_lies_on_the_sheet(mesh, fitted):
    _, state, patch, _ = fitted
    inner = np.linalg.norm(patch[:, :2], axis=1) < 0.6 * np.linalg.norm(patch[:, :2], axis=1).max()
    assert np.abs(patch[inner, 2] - state.position[0, 2]).max() < 1e-3 * RADIUS


def test_rows_sum_to_one_and_the_rim_is_given(mesh, fitted):
    placed = fitted[0].map
    sums = placed.weights[~mesh.rim].sum(axis=1)
    assert sums.max() == pytest.approx(1.0)
    given = np.linalg.norm(mesh.points[mesh.patch_points][~mesh.rim][:, :2], axis=1)
    # Beside the rim a crease gives way to it, by a share, and the rim itself is given.
    assert sums[given < 0.7] == pytest.approx(1.0)
    assert sums.min() > 0.9
    assert (placed.weights[mesh.rim] == 0.0).all()


def test_work_is_conserved(mesh, fitted):
    placed, state = fitted[0].map, fitted[1]
    generator = np.random.default_rng(2)
    force = generator.normal(size=(len(mesh.patch_points), 3))
    move = generator.normal(size=state.position.shape)
    moved = placed.to_flow(state.position + move) - placed.to_flow(state.position)
    assert np.sum(placed.to_cloth(force) * move) == pytest.approx(np.sum(force * moved))


def own_area(sheet, position):
    """A third of the area vectors of every node's triangles (n, 3)."""
    a, b, c = (position[sheet.triangles[:, k]] for k in range(3))
    own = np.zeros_like(position)
    np.add.at(own, sheet.triangles, (cross(b - a, c - a) / 6.0)[:, None])
    return own


def test_sparse_rows_are_mapped_as_forces_are(mesh, fitted):
    mapping, _, patch, _ = fitted
    rows = swept_rows(patch, mesh.patch_faces)
    mapped = mapping.map.rows_to_cloth(rows)
    for face in range(0, len(mesh.patch_faces), 20):
        force = rows[[face]].toarray().reshape(-1, 3)
        wanted = mapping.map.to_cloth(force)
        assert mapped[face] == pytest.approx(wanted, abs=1e-13 * np.abs(mapped).max())


def test_a_uniform_pressure_bears_on_every_nodes_own_area(sheet, mesh, fitted):
    mapping, state, patch, _ = fitted
    even = np.ones(mesh.diaphragm_faces)
    force = mapping.map.to_cloth(pressure_force(patch, mesh.patch_faces, even))
    assert force == pytest.approx(own_area(sheet, state.position), abs=1e-12)


def test_a_wave_reaches_the_liquid_with_its_volume(sheet, mesh):
    """The lateral wave of a half full tank is highest at the shell, in the last row of faces."""
    state = at_rest(sheet, 0.5)
    mapping = patch_map(mesh, sheet)
    placed = mapping.begin_step(state, 0.0, state.position)
    patch = placed.to_flow(state.position)
    wave = np.zeros_like(state.position)
    wave[:, 2] = state.position[:, 0] ** 3 * ~sheet.fixed
    faces = patch[mesh.patch_faces]
    moved = (placed.to_flow(state.position + wave) - patch)[mesh.patch_faces]
    swept = np.einsum("fkx,fkx->f", swept_gradient(faces), moved)
    own = np.einsum("nx,nx->n", own_area(sheet, state.position), wave)
    # What the nodes' volumes have of moments the shares keep, in the moulded shape, to its bend
    # over a face; interpolation with a fixed rim misses a quarter here.
    assert swept @ faces.mean(axis=1)[:, 0] == pytest.approx(own @ state.position[:, 0], rel=0.06)


def test_constants_reach_every_node(mesh, fitted):
    mapping = fitted[0]
    assert mapping.to_nodes(np.full(mesh.diaphragm_faces, 3.0)) == pytest.approx(3.0)


def test_nothing_slides_while_nothing_moves(mesh, fitted):
    mapping, state, patch, shell = fitted
    again = mapping.begin_step(state, 0.01, state.position + 0.01 * state.velocity)
    assert (again.shell == shell).all()
    assert (again.to_flow(state.position) == patch).all()


def test_map_is_restored(sheet, mesh):
    state = at_rest(sheet, 0.3)
    one, two = (patch_map(mesh, sheet) for _ in range(2))
    for mapping in (one, two):
        mapping.begin_step(state, 0.0, state.position)
    state.velocity = state.position * (0.0, 0.5, 0.2)
    state.velocity[sheet.fixed] = 0.0
    one.begin_step(state, 0.01, state.position + 0.01 * state.velocity)
    two.restore(one.save())
    ahead = state.position + 0.01 * state.velocity
    maps = [mapping.begin_step(state, 0.01, ahead) for mapping in (one, two)]
    assert (maps[0].shell == maps[1].shell).all()
    assert (maps[0].weights == maps[1].weights).all()


def test_sliding_sweeps_little_and_closes(sheet, mesh):
    """The same sheet through another map: the patch's facets change, the liquid's volume not."""
    state = at_rest(sheet, 0.3)
    mapping = patch_map(mesh, sheet)
    following = FollowingMesh(mesh, SHELL)
    placed = mapping.begin_step(state, 0.0, state.position)
    following.place(placed.to_flow(state.position), placed.shell)
    lifted = at_rest(sheet, 0.4)
    moving = SimpleNamespace(
        position=state.position, velocity=lifted.position - state.position, volume=state.volume
    )
    ahead = mapping.begin_step(moving, 0.2, moving.position + 0.2 * moving.velocity)
    following.begin_step(ahead.shell)
    start = following.close_volume(ahead.to_flow(state.position))
    swept = following.follow(start, "t = 0.2 s")
    assert abs(swept.sum()) < 1e-14 * state.volume
    assert np.abs(swept[: mesh.diaphragm_faces]).max() > 1e-6 * state.volume
    # The shell's facets slide on one sphere, no deeper in it than their sagitta, before and after.
    corner = following.points[mesh.faces[mesh.shell]]
    across = np.linalg.norm(corner[:, [0, 1]] - corner[:, [2, 3]], axis=2).max()
    area = np.linalg.norm(face_centres_and_areas(corner)[1], axis=1)
    assert np.abs(swept[mesh.diaphragm_faces :] / area).max() < 2 * across**2 / (8 * RADIUS)


def test_a_crease_is_rounded(sheet, mesh):
    """A fold pressed together, 0.3 R deep: the patch's faces stand back to back in it."""
    state = at_rest(sheet, 0.5)
    x, y, _ = state.position.T / RADIUS
    inside = np.clip(1 - x**2 - y**2, 0, 1)
    state.position[:, 2] -= 0.3 * RADIUS * np.exp(-(((x + 0.1) / 0.1) ** 2)) * inside
    state.position[:, 0] -= np.where(np.abs(x + 0.1) < 0.2, 0.9 * RADIUS * (x + 0.1) * inside, 0)
    skewed = []
    for settings in (PatchSettings(rounds=0), PatchSettings()):
        mapping = patch_map(mesh, sheet, settings)
        following = FollowingMesh(mesh, SHELL)
        placed = mapping.begin_step(state, 0.0, state.position)
        following.place(placed.to_flow(state.position), placed.shell)
        skewed.append(following.non_orthogonality_max)
    assert skewed[1] < skewed[0] - 5.0
    assert skewed[1] < 25.0


def test_least_sine_of_a_square_a_lozenge_and_a_dart():
    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    lozenge = [(0, 0), (2, 0), (2 + np.sqrt(3), 1), (np.sqrt(3), 1)]  # of 30 degrees
    dart = [(0, 0), (1, 1), (0, 3), (0.5, 1)]  # the last corner points inward
    corners = np.pad(np.array([square, lozenge, dart], dtype=float), ((0, 0), (0, 0), (0, 1)))
    upward = np.tile([0.0, 0.0, 1.0], (3, 1))
    assert least_sine(corners, upward)[:2] == pytest.approx([1.0, 0.5])
    assert least_sine(corners, upward)[2] < 0.0


def test_a_patch_thrown_through_the_shell_stays_inside(sheet, mesh):
    """As by a map that goes on linearly in a slam: the row beside the rim, on one side."""
    state = at_rest(sheet, 0.8)
    mapping = patch_map(mesh, sheet)
    placed = mapping.begin_step(state, 0.0, state.position)
    patch = placed.to_flow(state.position)
    following = FollowingMesh(mesh, SHELL)
    following.place(patch, placed.shell)
    following.begin_step(None)
    reach = np.linalg.norm(mesh.points[mesh.patch_points], axis=1)
    beside = ~mesh.rim & (reach > 0.75) & (patch[:, 0] > 0.6 * patch[:, 0].max())
    out = patch / np.linalg.norm(patch, axis=1)[:, None]
    thrown = following.close_volume(np.where(beside[:, None], 1.05 * RADIUS * out, patch))
    assert np.linalg.norm(thrown, axis=1)[beside].min() > np.linalg.norm(placed.shell[0])
    swept = following.follow(thrown, "t = 0.01 s")
    following.accept_step()
    assert np.linalg.norm(following.patch, axis=1)[~mesh.rim].max() < RADIUS
    assert following.geometry.volume.min() > 0
    assert abs(swept.sum()) < 1e-14 * state.volume


def test_points_give_way_to_their_neighbours_all_at_once():
    """Against the formula, on a ring: no point sees where another has just moved."""
    count, share = 7, np.linspace(0.0, 0.9, 7)
    others = np.array([[(i - 1) % count, (i + 1) % count] for i in range(count)])
    values = np.random.default_rng(3).normal(size=(count, 2))
    expected = (1 - share[:, None]) * values + share[:, None] * values[others].mean(axis=1)
    give_way(values, np.arange(1, count), share, 2 * np.arange(count + 1), others.ravel())
    np.testing.assert_allclose(values, expected, atol=1e-15)


def test_an_outline_that_no_size_fits_is_a_step_that_failed(sheet, mesh):
    patch = patch_map(mesh, sheet)
    points = np.zeros((len(mesh.patch_points), 3))
    shell = RADIUS * mesh.points[mesh.shell_points]
    with pytest.raises(StepFailed, match="cannot follow") as failed:
        patch._size(points, shell, 10.0 * RADIUS**3)
    assert failed.value.cause is Cause.MESH
