"""Gradients, and values on the walls, of linear fields in a leaning box."""

import numpy as np
import pytest

from coupling.finite_volume.geometry import cell_geometry
from coupling.finite_volume.gradients import gradients
from coupling.finite_volume.mesh import assemble


def leaning_box(lean):
    """6^3 cells of the unit box, its top shifted by ``lean`` along x; mesh and geometry."""
    side = np.arange(7) / 6
    points = np.stack(np.meshgrid(side, side, side, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(7**3).reshape(7, 7, 7)
    corner = [
        (0, 0, 0),
        (1, 0, 0),
        (1, 1, 0),
        (0, 1, 0),
        (0, 0, 1),
        (1, 0, 1),
        (1, 1, 1),
        (0, 1, 1),
    ]
    hexes = [number[i : i + 6, j : j + 6, k : k + 6].ravel() for i, j, k in corner]
    mesh = assemble(points, np.stack(hexes, axis=1), top=0.99)
    return mesh, cell_geometry(mesh, points + lean * points[:, 2:] * [1.0, 0.0, 0.0])


@pytest.mark.parametrize(("lean", "share"), [(0.0, 1.0), (0.6, 1.0), (-0.9, 1.0), (2.0, 0.5)])
def test_linear_field_along_the_wall(lean, share):
    mesh, geometry = leaning_box(lean)
    own = mesh.owner[mesh.inner_faces :]
    values = geometry.centre @ [1.0, -0.3, 0.0]
    got = gradients(mesh, geometry).on_walls(own, values)[: mesh.diaphragm_faces]
    wanted = geometry.face_centre[mesh.diaphragm] @ [1.0, -0.3, 0.0]
    alone = (np.bincount(own)[own] == 1)[: mesh.diaphragm_faces]
    beside = values[own[: mesh.diaphragm_faces]]
    # No further aside than the cell is high: of a lean of 2, half the way.
    assert alone.sum() == 16
    assert got[alone] == pytest.approx((beside + share * (wanted - beside))[alone], abs=1e-12)
    assert got[~alone] == pytest.approx(beside[~alone], abs=1e-12)


def test_gradient_of_a_linear_field_inside():
    mesh, geometry = leaning_box(0.6)
    found = gradients(mesh, geometry)
    values = geometry.centre @ [1.0, -0.3, 0.7]
    got = np.einsum("ckx,ck->cx", found.cells, values[found.columns])
    inside = np.setdiff1d(np.arange(mesh.cells), mesh.owner[mesh.inner_faces :])
    assert got[inside] == pytest.approx(np.tile([1.0, -0.3, 0.7], (len(inside), 1)), abs=1e-12)
