"""Values of one diaphragm mesh at the material points of another."""

from __future__ import annotations

import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.thesis.grid import thesis_grid
from coupling.metrics.material import material_interpolation
from coupling.ports import Array, Ints


def field(points: Array) -> Array:
    x, y, z = points[:, 0], points[:, 1], np.abs(points[:, 2])
    return np.asarray(np.sin(3.0 * x) * z + x * y - y)


def rings(count: int) -> tuple[Array, Ints]:
    mesh = hemisphere(0.4, count)
    return mesh.points / 0.4, mesh.triangles


def square(size: int) -> tuple[Array, Ints]:
    grid = thesis_grid(1.0, size)
    return grid.points, grid.triangles


def test_every_node_is_its_own_place() -> None:
    """But for two corners of the square: their only triangle lies in the rim's plane."""
    for (points, triangles), corners in ((rings(9), 0), (square(12), 2)):
        taken = material_interpolation(points, triangles, points)
        missed = np.abs(taken @ field(points) - field(points)) > 1e-12
        assert missed.sum() == corners
        assert np.abs(points[missed, 2]).max(initial=0.0) == 0.0


@pytest.mark.parametrize(("mesh", "sizes"), [(rings, (7, 13, 25)), (square, (14, 26, 50))])
def test_the_error_falls_as_the_square_of_the_spacing(mesh, sizes) -> None:  # type: ignore[no-untyped-def]
    places, _ = rings(10)
    errors = []
    for size in sizes:
        points, triangles = mesh(size)
        taken = material_interpolation(points, triangles, places)
        assert taken.data.min() > -1e-12  # every place lies in the triangle that was chosen
        assert taken.sum(axis=1) == pytest.approx(np.ones(len(places)), abs=1e-12)
        errors.append(float(np.sqrt(np.mean((taken @ field(points) - field(places)) ** 2))))
    order = -np.polyfit(np.log(sizes), np.log(errors), 1)[0]
    # places differ in where they lie within their triangles: that scatters the order
    assert order == pytest.approx(2.0, abs=0.3)
    assert errors[-1] < 4e-3


def test_the_moulded_shape_is_missed_by_the_sag_of_its_facets() -> None:
    """At most h^2/(8 R) with h the longest edge; 1.54 spacings at the most."""
    points, triangles = rings(16)
    places, _ = rings(23)
    taken = material_interpolation(points, triangles, places)
    missed = np.linalg.norm(taken @ points - places, axis=1)
    longest = max(
        np.linalg.norm(points[triangles[:, k]] - points[triangles[:, k - 1]], axis=1).max()
        for k in range(3)
    )
    # within a triangle the distance to the sphere is below circumradius^2/2, a third of h^2/2
    assert 1e-4 < missed.max() < longest**2 / 6.0 * 1.1


def test_the_side_on_which_it_was_moulded_does_not_matter() -> None:
    points, triangles = rings(8)
    below = points * [1.0, 1.0, -1.0]
    places, _ = square(10)
    taken = material_interpolation(points, triangles, places)
    assert np.array_equal(
        taken.toarray(), material_interpolation(below, triangles, places).toarray()
    )
