"""The half ball's mesh below a liquid deeper than a ball's: how it is divided, its waves."""

import numpy as np
import pytest
from shells import pill

from cloth.shell.meridian import Meridian
from cloth.shell.pieces import arc
from cloth.shell.sphere import Sphere
from coupling.finite_volume.blocks import Divisions, depth_cells
from coupling.finite_volume.coarsening import coarsening, coarser_for
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.liquid_inertia import NeumannLaplacian
from coupling.finite_volume.mesh import divided, half_ball
from coupling.finite_volume.mesh_sizes import (
    LONGEST,
    cells_above,
    cells_halved,
    cells_least,
    cells_made,
    length_for,
)
from coupling.scene.scene import SceneError, scene_from
from coupling.verify.level_tank import RADIUS, level_shape, level_tank
from coupling.verify.slosh import EIGENVALUES

UP, ACROSS = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
LENGTHS = [0.4, 1.0, 1.6]


def test_length_goes_with_the_tanks_and_the_liquids():
    """Twice the radius for a full pill of 2:1 that stands, nothing of a sphere or a lying tank."""
    shell = pill(0.2, 0.2)
    assert [length_for(shell, UP, fill) for fill in (0.3, 0.5, 0.8)] == [0.6, 1.0, 1.6]
    assert length_for(shell, -9.81 * UP, 0.8) == 1.6
    assert length_for(shell, UP + ACROSS, 0.8) == pytest.approx(1.6 / np.sqrt(2.0), abs=0.005)
    assert length_for(shell, ACROSS, 0.8) == 0.0
    assert length_for(shell, 0.0 * UP, 0.8) == 0.0
    assert length_for(pill(0.2, 2.0), UP, 0.8) == LONGEST
    assert length_for(Sphere(0.3), UP, 0.8) == 0.0
    # Clamped above its middle a sphere is as long as it is wide all the same.
    quarters = [arc((0.0, -0.1), 0.3, s - np.pi / 2, s) for s in (0.0, np.pi / 2)]
    assert length_for(Meridian(quarters), UP, 0.8) == 0.0


def test_without_a_length_nothing_is_changed():
    own, same = Divisions.of(8, 0.0), Divisions.of(8, 0.0, 0.0, 7)
    assert np.array_equal(own.depth, same.depth)
    assert np.array_equal(own.depth, np.linspace(-1.0, 0.0, 5))


@pytest.mark.parametrize("length", LENGTHS)
def test_a_long_half_ball_is_one_on_a_cylinder(length):
    """Its points lie on it, its volume tends to theirs from inside, and its cells are as long."""
    mesh = half_ball(4500, 0.0, length)
    assert mesh.points[mesh.patch_points][:, 2] == pytest.approx(0.0, abs=1e-15)
    wall = mesh.points[mesh.shell_points] + [0.0, 0.0, length]
    below = np.minimum(wall[:, 2], 0.0)
    assert np.hypot(np.linalg.norm(wall[:, :2], axis=1), below) == pytest.approx(1.0, abs=1e-12)
    assert wall[:, 2].min() == pytest.approx(-1.0)
    geometry = cell_geometry(mesh, mesh.points)
    assert geometry.volume.min() > 0
    # Facets of 40 chords around and as wide along hold 1 - 2/3 (pi/40)^2 and twice that less.
    exact = np.pi * (2.0 / 3.0 + length)
    assert 0.985 * exact < geometry.volume.sum() < exact
    # On the wall a cell is no longer than twice its width, nor shorter than a quarter of it.
    corner = mesh.points[mesh.faces[mesh.shell]]
    edge = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2)
    shape = edge[:, [0, 2]].mean(axis=1) / edge[:, [1, 3]].mean(axis=1)
    assert np.maximum(shape, 1.0 / shape).max() < 4.0


@pytest.mark.parametrize(("spacing", "asked"), [(0.0, 5000), (0.01, 16000)])
@pytest.mark.parametrize("length", LENGTHS)
def test_sizes_are_those_of_the_meshes(length, spacing, asked):
    """The mesh made is the finest of at most so many cells; the others follow from it."""
    counts = range(asked // 2, 2 * asked, 97)
    made = [cells_made(cells, spacing, length) for cells in counts]
    assert all(own <= cells for own, cells in zip(made, counts, strict=True))
    assert (np.diff(made) >= 0).all()
    assert half_ball(asked, spacing, length).cells == cells_made(asked, spacing, length)
    above = cells_above(asked, spacing, length)
    assert cells_made(above, spacing, length) == above > asked
    assert cells_made(above - 1, spacing, length) == cells_made(asked, spacing, length)
    half = cells_halved(asked, spacing, length)
    assert 0.2 < half / cells_made(asked, spacing, length) < 0.8
    least = cells_least(4, spacing, length)
    assert cells_made(least, spacing, length) == least


def test_cells_are_graded_to_the_walls():
    spacing = 0.004
    mesh = half_ball(5000, spacing, 1.6)
    geometry = cell_geometry(mesh, mesh.points)
    assert geometry.volume.min() > 0
    walls = slice(mesh.inner_faces, None)
    area = geometry.face_area[walls]
    normal = area / np.linalg.norm(area, axis=1)[:, None]
    reach = geometry.face_centre[walls] - geometry.centre[mesh.owner[walls]]
    assert (2.0 * np.sum(reach * normal, axis=1)).max() < spacing * (1.0 + 1e-12)


def test_a_coarser_mesh_is_as_long():
    fine = half_ball(4700, 0.0, 1.6)
    found = coarser_for(fine, 200)
    assert found is not None
    assert found.mesh.divisions.length == 1.6
    assert found.mesh.diaphragm_faces >= 0.55 * 200
    points = found.points @ fine.points
    # Linear along two edges of length h of the wall: h^2/8 each, and as much again along it.
    corner = fine.points[fine.faces[fine.shell]]
    longest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max()
    assert np.abs(points - found.mesh.points).max() < 0.5 * longest**2
    assert found.faces.sum(axis=0) == pytest.approx(1.0, abs=1e-14)
    with pytest.raises(ValueError, match="no coarsening"):
        coarsening(fine, divided(Divisions.of(6, 0.0, 0.8)))


def wave_error(cells, level):
    """Relative error of omega^2 of a pill's lowest lateral mode by the mesh's inertia alone."""
    tank = level_tank("pill")
    height = level * RADIUS + tank.lowest
    fill = tank.volume_below(height) / tank.shell.volume
    mesh = half_ball(cells, 0.0, length_for(tank.shell, UP, fill))
    patch, shell, _, _ = level_shape(mesh, tank, height)
    following = FollowingMesh(mesh, tank)
    following.place(patch, shell)
    geometry = following.geometry
    area = geometry.face_area[mesh.diaphragm][:, 2]
    mean = np.eye(len(area)) - np.outer(np.ones(len(area)), area / area.sum())
    root = np.sqrt(area)
    operator = mean @ NeumannLaplacian(mesh, geometry).trace() @ mean.T
    value, vector = np.linalg.eigh(root[:, None] * operator * root)
    away = geometry.face_centre[mesh.diaphragm][:, 0]
    lateral = np.abs((root * away) @ vector[:, -4:])
    return RADIUS / value[-4:][np.argmax(lateral)] / EIGENVALUES["pill"][level, 1] - 1.0


@pytest.mark.parametrize(("level", "cells"), [(1.5, 1300), (2.0, 1300), (3.0, 1300)])
def test_waves_of_a_deep_liquid_are_as_right_as_a_balls(level, cells):
    """In a sphere as full the mesh of 1,216 cells errs by 0.4 to 1.9 %; even n/2 cells to 3.9 %."""
    assert abs(wave_error(cells, level)) < 0.019


def test_waves_of_a_deep_liquid_are_of_second_order():
    """Meshes of one ratio of the cells along the depth to those across: 4 and 6, 8 and 12."""
    coarse, fine = (wave_error(cells, 3.0) for cells in (432, 3008))
    assert 1.6 < np.log2(coarse / fine) < 2.8


def test_cells_have_the_depth_that_they_are_asked_for():
    assert depth_cells(8, 0.0) == 4
    assert [len(Divisions.of(n, 0.0, np.pi / 4).depth) - 1 for n in (4, 8)] == [4, 8]


def test_a_scene_s_mesh_goes_with_its_tank():
    """Fewer cells than the coarsest mesh are refused; what is made otherwise hangs on the fill."""
    scene = {
        "tank": {"shape": "pill", "radius": 0.2, "cylinder_length": 0.4},
        "diaphragm": {"material": "AF-E-332", "thickness": 0.001778},
        "liquid": {"name": "water", "fill_fraction": 0.8},
        "time": {"duration": 1.0},
    }
    assert scene_from(scene).half_ball == (1300, 0.0, 1.6)
    assert scene_from(scene | {"gravity": [9.81, 0.0, 0.0]}).half_ball == (1300, 0.0, 0.0)
    assert scene_from(scene | {"tank": {"radius": 0.2}}).half_ball == (1300, 0.0, 0.0)
    with pytest.raises(SceneError, match=r"in so long a tank the coarsest mesh has 368 cells, got"):
        scene_from(scene | {"openfoam": {"cells": 300}})
