"""What a coarser half ball takes over from a finer one, and the inertia found on it."""

import math

import numpy as np
import pytest

from coupling.finite_volume.blocks import Divisions
from coupling.finite_volume.coarsening import coarsening, coarser_for, prolongations
from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import divided, half_ball
from coupling.finite_volume.mesh_sizes import FACES, coarsest_for
from coupling.verify.prism import prism_mesh

DENSITY = 1000.0


def of(n):
    """The half ball with ``n`` cells across its cube."""
    return divided(Divisions.of(n, 0.0))


def bent(points):
    """Points (P, 3) of a bent liquid."""
    return points + 0.05 * np.sin(4 * points[:, [1, 2, 0]])


@pytest.fixture(scope="module")
def fine():
    return half_ball(1300)


def test_points_that_both_meshes_have_are_taken_over(fine):
    # A point of n = 4 is every other one of n = 8 across; along the wrapping layers, m = 3 and 5,
    # it lies between two, on a straight line: there and only there blocks are interpolated exactly.
    coarse = coarsening(fine, of(4))
    points = coarse.points @ fine.points
    assert points == pytest.approx(coarse.mesh.points, abs=1e-12)
    assert (coarse.points @ np.ones(len(fine.points))) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("n", [6, 14])
def test_points_on_the_shell_are_interpolated_to_second_order(n):
    # Linear interpolation along two edges of length h of the unit sphere errs by h^2/8 each, and
    # less than as much again along the sphere, where the points are not evenly spaced.
    mesh = of(n)
    corner = mesh.points[mesh.faces[mesh.shell]]
    longest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max()
    coarse = coarsening(mesh, of(4))
    error = (coarse.points @ mesh.points - coarse.mesh.points)[coarse.mesh.shell_points]
    away = np.linalg.norm(error, axis=1).max()
    assert 0.05 * longest**2 < away < 0.5 * longest**2
    geometry = cell_geometry(coarse.mesh, coarse.points @ bent(mesh.points))
    assert geometry.volume.min() > 0


def test_faces_keep_every_volume(fine):
    coarse = coarsening(fine, of(6))
    assert coarse.faces.shape == (coarse.mesh.diaphragm_faces, fine.diaphragm_faces)
    assert coarse.faces.sum(axis=0) == pytest.approx(1.0, abs=1e-14)
    # A face takes from those on it: their centre is its own, within the blocks' own distortion.
    centre, finer = (m.points[m.faces[m.diaphragm]].mean(axis=1) for m in (coarse.mesh, fine))
    share = coarse.faces / coarse.faces.sum(axis=1)[:, None]
    assert np.linalg.norm(share @ finer - centre, axis=1).max() < 0.02


def test_graded_meshes_are_made_coarser_too():
    fine, coarse = half_ball(5000, 0.004), of(4)
    found = coarsening(fine, coarse)
    assert (found.points @ np.ones(len(fine.points))) == pytest.approx(1.0, abs=1e-14)
    geometry = cell_geometry(coarse, found.points @ bent(fine.points))
    assert geometry.volume.min() > 0
    assert found.faces.sum(axis=0) == pytest.approx(1.0, abs=1e-13)
    lifted = np.linalg.norm(geometry.face_area[coarse.diaphragm], axis=1)
    finer = cell_geometry(fine, bent(fine.points)).face_area[fine.diaphragm]
    # The faces' areas, summed; across the disc the finer rim holds a little more.
    assert found.faces @ np.linalg.norm(finer, axis=1) == pytest.approx(lifted, rel=0.2)
    assert coarser_for(half_ball(1800, 0.0045), 592) is None  # fewer across than the inertia needs


def test_only_a_mesh_finer_than_the_structure_is_made_coarser(fine):
    nodes = math.floor(fine.diaphragm_faces / FACES)
    assert coarsest_for(nodes, fine.divisions).cells == fine.cells
    assert coarser_for(fine, nodes) is None
    nodes = math.floor(of(6).diaphragm_faces / FACES)
    found = coarser_for(fine, nodes)
    assert found is not None
    assert found.mesh.cells == Divisions.of(6, 0.0).cells
    assert coarser_for(fine, nodes + 2) is None


def test_what_is_no_coarser_half_ball_is_refused(fine):
    with pytest.raises(ValueError, match="no coarsening of a mesh of 1216 cells to one of 2300"):
        coarsening(fine, of(10))
    with pytest.raises(ValueError, match="no coarsening"):
        coarsening(prism_mesh(400, 1.0), of(4))


def test_prolongations_lead_down_to_a_coarse_mesh(fine):
    inside = np.setdiff1d(np.arange(len(fine.points)), fine.faces[fine.inner_faces :])
    lines = prolongations(fine, inside, 100)
    assert [line.shape for line in lines] == [(1032, 132), (132, 18)]
    assert lines[0].sum(axis=1).max() == pytest.approx(1.0, abs=1e-14)
    assert prolongations(prism_mesh(400, 1.0), np.arange(3), 1) == []


def test_inertia_on_the_same_mesh_is_the_flows_own(fine):
    points = bent(fine.points)
    same = LiquidInertia.on(coarsening(fine, fine), fine, points, DENSITY)
    patch = points[fine.patch_points]
    own = LiquidInertia.of(NeumannLaplacian(fine, cell_geometry(fine, points)), patch, DENSITY)
    motion = np.random.default_rng(0).normal(size=patch.shape)
    wanted = own.force(motion)
    assert np.abs(same.force(motion) - wanted).max() < 1e-10 * np.abs(wanted).max()


def energies(points, mesh, waves, coarse):
    """Twice the kinetic energy of standing waves of the surface, on a coarser mesh and its own."""
    patch = points[mesh.patch_points]
    own = LiquidInertia.of(NeumannLaplacian(mesh, cell_geometry(mesh, points)), patch, DENSITY)
    found = LiquidInertia.on(coarse, mesh, points, DENSITY)
    for wave in waves:
        rise = np.zeros_like(patch)
        rise[:, 2] = np.cos(patch[:, :2] @ wave) * (1.0 - np.sum(patch[:, :2] ** 2, axis=1))
        yield np.vdot(rise, found.force(rise)), np.vdot(rise, own.force(rise))


def test_inertia_on_a_coarser_mesh_holds_the_waves_that_it_resolves(fine):
    # n = 6 within n = 8. Of a wave with x = k h/2 square faces of width h leave s (1 + s^2)^(1/2)/x
    # of the inertia, s = sin x: 1.05 for x = .5, 1.1 for 1. The finer mesh has an excess of its
    # own, of 2 and 6 %; the longest faces are 1.7 times as long as the mean: x goes up to 1.2.
    coarse = coarsening(fine, of(6))
    size = np.sqrt(np.pi / coarse.mesh.diaphragm_faces)
    for x in (0.2, 0.45, 0.7):
        k = 2.0 * x / size
        turns = [k * np.array([np.cos(a), np.sin(a)]) for a in (0.0, 0.4, 0.8)]
        for got, wanted in energies(fine.points, fine, turns, coarse):
            assert 0.99 < got / wanted < 1.06


def test_uniform_lift_has_no_inertia_on_a_coarser_mesh(fine):
    inertia = LiquidInertia.on(coarsening(fine, of(6)), fine, fine.points, DENSITY)
    lift = np.zeros_like(fine.points[fine.patch_points])
    lift[:, 2] = 1.0
    tilt = lift * fine.points[fine.patch_points][:, :1]
    assert np.abs(inertia.force(lift)).max() < 1e-10 * np.abs(inertia.force(tilt)).max()


def test_force_is_the_pressure_on_what_the_flows_faces_sweep(fine):
    points = bent(fine.points)
    inertia = LiquidInertia.on(coarsening(fine, of(6)), fine, points, DENSITY)
    motion = np.random.default_rng(0).normal(size=(len(fine.patch_points), 3))
    assert inertia.pressure(motion).shape == (fine.diaphragm_faces,)
    force = inertia.force(motion)
    wanted = np.tensordot(np.tensordot(inertia.rows, motion, 2), inertia.rows, 1)
    assert np.abs(force - wanted).max() < 1e-12 * np.abs(wanted).max()  # the same sums, reordered
    assert inertia.weighted(inertia.swept.toarray().reshape(-1, len(motion), 3)) == pytest.approx(
        inertia.rows, abs=1e-12 * np.abs(inertia.rows).max()
    )
