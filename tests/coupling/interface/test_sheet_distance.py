"""How far points lie from a sheet."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from coupling.interface.sheet_distance import distance_to_sheet

RADIUS = 0.4445


def test_distance_of_points_outside_a_convex_sheet_is_their_height():
    sheet = hemisphere(RADIUS, 12)
    a, b, c = (sheet.points[sheet.triangles[:, k]] for k in range(3))
    centre, normal = (a + b + c) / 3.0, np.cross(b - a, c - a)
    outward = normal * np.sign(np.sum(normal * centre, axis=1))[:, None]
    outward /= np.linalg.norm(outward, axis=1)[:, None]
    height = np.linspace(0.0, 0.03, len(centre))
    found = distance_to_sheet(centre + height[:, None] * outward, sheet.points, sheet.triangles)
    assert found == pytest.approx(height, abs=1e-15)


def test_nodes_and_edges_lie_on_their_sheet():
    sheet = hemisphere(RADIUS, 12)
    middles = sheet.points[sheet.triangles[:, :2]].mean(axis=1)
    points = np.concatenate([sheet.points, middles])
    found = distance_to_sheet(points, sheet.points, sheet.triangles)
    assert found.max() < 1e-15


def test_beyond_the_rim_the_edge_is_what_is_nearest():
    sheet = hemisphere(RADIUS, 12)
    below = sheet.points[sheet.fixed] - (0.0, 0.0, 0.03)
    found = distance_to_sheet(below, sheet.points, sheet.triangles)
    assert found == pytest.approx(0.03)
