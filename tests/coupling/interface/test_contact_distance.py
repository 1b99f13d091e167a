"""How far the nodes of a sheet are beyond where it rests on the shell."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere
from coupling.interface.contact_distance import ContactDistance

RADIUS, RINGS = 0.4445, 48
EDGE = 0.5 * np.pi / RINGS * RADIUS  # about


@pytest.fixture(scope="module")
def sheet():
    return hemisphere(RADIUS, RINGS)


def test_nothing_is_beyond_contact_on_the_shell(sheet):
    found = ContactDistance(sheet.triangles, Sphere(RADIUS)).of(sheet.points)
    assert found == pytest.approx(0.0, abs=1e-9)


def test_a_level_sheet_is_as_far_as_its_corner_with_the_shell(sheet):
    x, level = sheet.points.copy(), 0.4 * RADIUS
    # A disc, level to its edge on the shell: a corner of 66 degrees.
    polar, edge = np.arccos(np.clip(x[:, 2] / RADIUS, -1.0, 1.0)), np.arccos(0.4)
    across = np.linalg.norm(x[:, :2], axis=1)
    within = polar < edge
    reach = np.where(within, np.sin(edge) * RADIUS * polar / edge, across)
    x[:, :2] *= (reach / np.maximum(across, 1e-12))[:, None]
    x[within, 2] = level
    found = ContactDistance(sheet.triangles, Sphere(RADIUS)).of(x)
    wanted = (RADIUS * np.sin(edge) - np.linalg.norm(x[:, :2], axis=1)) / EDGE
    near = within & (wanted > 0.0) & (wanted < 2.0)
    assert near.sum() > 100
    # The gap is no straight line over two edges: its slope falls from .92 to .86 there.
    assert found[near] == pytest.approx(wanted[near], rel=0.25, abs=0.1)


def test_a_film_is_no_end_of_contact(sheet):
    # A thousandth of the gap that a straight sheet has one edge beyond where it leaves.
    film = 1e-3 * EDGE**2 / (2.0 * RADIUS)
    x = np.where(sheet.fixed[:, None], 1.0, 1.0 - film / RADIUS) * sheet.points
    found = ContactDistance(sheet.triangles, Sphere(RADIUS)).of(x)
    beside_rim = np.isin(sheet.triangles, np.flatnonzero(sheet.fixed)).any(axis=1)
    inner = np.setdiff1d(np.arange(len(x)), sheet.triangles[beside_rim])
    assert found[inner] == pytest.approx(0.1, rel=0.3)


def test_where_the_sheet_leaves_along_the_tangent_gap_and_slope_grow_with_the_distance(sheet):
    x = sheet.points.copy()
    polar, edge = np.arccos(np.clip(x[:, 2] / RADIUS, -1.0, 1.0)), np.radians(50.0)
    away = np.maximum(edge - polar, 0.0)
    x *= (1.0 - 0.5 * away**2)[:, None]
    found = ContactDistance(sheet.triangles, Sphere(RADIUS)).of(x)
    wanted = away * RADIUS / EDGE
    near = (wanted > 1.0) & (wanted < 4.0)
    # s^2/2 over the slope towards the next node, s + 1/2 at the most, edges as the unit.
    assert (found[near] < 0.5 * wanted[near] * 1.1).all()
    assert (found[near] > 0.5 * wanted[near] ** 2 / (wanted[near] + 0.5) * 0.8).all()
