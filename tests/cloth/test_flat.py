"""Flat meshes: flat, of the right area, symmetric as they say."""

from __future__ import annotations

import numpy as np
import pytest

from cloth.flat import disc, disc_pair, strip
from cloth.mesh import rest_gradients


def normals(mesh):
    x = mesh.points[mesh.triangles]
    return 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])


def edge_lengths(mesh):
    x = mesh.points[mesh.triangles]
    return np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2)


@pytest.mark.parametrize(("rings", "sectors"), [(2, 3), (5, 20), (8, 30)])
def test_disc_is_a_polygon_of_its_sectors(rings, sectors):
    mesh = disc(2.0, rings, sectors)
    assert len(mesh.points) == 1 + rings * sectors
    area = normals(mesh)
    assert np.all(area[:, 2] > 0.0)
    exact = 0.5 * sectors * 4.0 * np.sin(2.0 * np.pi / sectors)
    assert area[:, 2].sum() == pytest.approx(exact, rel=1e-12)
    np.testing.assert_allclose(np.linalg.norm(mesh.points[mesh.fixed], axis=1), 2.0, rtol=1e-14)
    assert mesh.fixed.sum() == sectors
    np.testing.assert_allclose(mesh.rim_distance[[0, -1]], [2.0, 0.0], atol=1e-12)


def test_disc_turned_by_a_sector_is_itself():
    sectors = 16
    mesh = disc(1.0, 4, sectors)
    following = np.arange(len(mesh.points))
    ring = (following[1:] - 1) // sectors
    following[1:] = 1 + ring * sectors + (following[1:] - 1 + 1) % sectors
    turned = {tuple(sorted(t)) for t in following[mesh.triangles].tolist()}
    assert turned == {tuple(sorted(t)) for t in mesh.triangles.tolist()}


def test_disc_pair_is_closed_and_opens_outward():
    mesh = disc_pair(1.5, 4, 12)
    count = len(mesh.triangles)
    ways = np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    forth = {tuple(way) for way in ways.tolist()}
    assert len(forth) == 3 * count  # every edge is run through once each way: closed, oriented
    assert forth == {(b, a) for a, b in forth}
    assert len(mesh.points) - 3 * count // 2 + count == 2  # Euler's sphere
    assert not mesh.fixed.any()
    np.testing.assert_allclose(normals(mesh).sum(axis=0), 0.0, atol=1e-12)
    x = mesh.points[mesh.triangles]
    assert np.einsum("td,td->", x[:, 0], normals(mesh)) > 0.0
    _, areas = rest_gradients(mesh.points, mesh.triangles)
    flat = disc(1.5, 4, 12)
    # The bulge of 1e-6 lengthens by its square.
    assert areas.sum() == pytest.approx(2.0 * normals(flat)[:, 2].sum(), rel=1e-11)


@pytest.mark.parametrize("width", [0.01, 0.3, 1.0])
def test_strip_is_its_mirror_image(width):
    mesh = strip(2.0, width, 12)
    area = normals(mesh)
    assert np.all(area[:, 2] > 0.0)
    assert area[:, 2].sum() == pytest.approx(2.0 * width, rel=1e-12)
    ends = mesh.points[mesh.fixed]
    assert set(ends[:, 0].tolist()) == {0.0, 2.0}
    mirrored = mesh.points * [1.0, -1.0, 1.0]
    gaps = np.linalg.norm(mirrored[:, None] - mesh.points[None], axis=2).min(axis=1)
    assert gaps.max() <= 1e-14
    assert len(np.unique(mesh.triangles)) == len(mesh.points)


def test_strip_is_near_equilateral_away_from_its_ends():
    mesh = strip(2.0, 1.0, 12)
    whole = np.abs(mesh.points[mesh.triangles, 0] - 1.0).max(axis=1) < 0.9
    lengths = edge_lengths(mesh)[whole]
    # Rows are rounded to an even number: at worst 1.5 rows become 2, or 3 become 2 or 4.
    assert lengths.max() / lengths.min() < 1.25


def test_sizes_that_make_no_sheet_are_refused():
    with pytest.raises(ValueError, match="2 rings"):
        disc(1.0, 1, 8)
    with pytest.raises(ValueError, match="3 sectors"):
        disc_pair(1.0, 4, 2)
    with pytest.raises(ValueError, match="radius"):
        disc(0.0, 4, 8)
    with pytest.raises(ValueError, match="2 segments"):
        strip(1.0, 0.1, 1)
    with pytest.raises(ValueError, match="width"):
        strip(1.0, 0.0, 4)
