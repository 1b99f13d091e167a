"""The free part of the diaphragm, found from where the sheet lies on the shell."""

import numpy as np
import pytest

from cloth.mesh import hemisphere
from cloth.shell.sphere import Sphere
from coupling.interface.contact_curve import (
    ContactSearch,
    ContactSettings,
    solid_angles,
    upright_frame,
)

RADIUS = 0.4445
AROUND = np.linspace(-np.pi, np.pi, 24, endpoint=False)


@pytest.fixture(scope="module")
def sheet():
    return hemisphere(RADIUS, 24)


def search(sheet):
    return ContactSearch(sheet.points / RADIUS, sheet.triangles, sheet.fixed, Sphere(RADIUS))


def lying(sheet, edge, *, up):
    """The sheet on the shell beyond the polar angle ``edge`` [deg], level within."""
    x = sheet.points.copy()
    level = RADIUS * np.cos(np.radians(edge))
    x[:, 2] = np.minimum(x[:, 2], level)
    return x if up else x * (1.0, 1.0, -1.0)


def test_hemisphere_has_half_the_solid_angle(sheet):
    angles = solid_angles(sheet.points, sheet.triangles)
    assert angles.min() > 0
    assert angles.sum() == pytest.approx(2 * np.pi, rel=1e-12)  # the rim closes on a great circle


@pytest.mark.parametrize("up", [True, False])
@pytest.mark.parametrize("edge", [35.0, 60.0, 75.0])
def test_edge_is_where_the_sheet_leaves_the_shell(sheet, edge, up):
    found = np.degrees(search(sheet).free_part(lying(sheet, edge, up=up), 0.0).edge(AROUND))
    # Half a triangle, 3.75 degrees wide; on the free side besides the reach of one such edge, by a
    # slope of the gap that falls by half over the next.
    assert found.max() < edge + 1.9
    assert found.min() > edge - 1.9 - 1.5 * 3.75
    assert np.ptp(found) < 0.2


def test_a_sheet_that_touches_nowhere_is_free_to_its_rim(sheet):
    x = np.where(sheet.fixed[:, None], sheet.points, 0.9 * sheet.points)
    part = search(sheet).free_part(x, 0.0)
    assert np.degrees(part.edge(AROUND)) == pytest.approx(90.0, abs=1e-3)
    assert part.frame[2] == pytest.approx([0, 0, 1], abs=1e-3)


def test_edge_follows_contact_on_one_side(sheet):
    x = sheet.points * (1.0, 1.0, 0.5)
    lies = sheet.points[:, 0] > 0.6 * RADIUS
    x[lies] = sheet.points[lies] * (1.0, 1.0, -1.0)
    part = search(sheet).free_part(x, 0.0)
    assert part.frame[2, 0] < -0.01  # the axis leans away from the contact
    edge = part.directions(part.edge(AROUND), AROUND)
    assert edge[np.argmax(edge[:, 0]), 0] == pytest.approx(0.6, abs=0.12)
    assert edge[np.argmin(edge[:, 0]), 0] < -0.98


def test_directions_beyond_the_edge_are_brought_to_it(sheet):
    part = search(sheet).free_part(lying(sheet, 60.0, up=True), 0.0)
    unit = sheet.points / RADIUS
    moved = part.within(unit, 0.9)
    most = 0.9 * part.edge(AROUND).max()
    assert np.arccos(moved @ part.frame[2]).max() == pytest.approx(most, abs=0.01)
    inside = unit @ part.frame[2] > np.cos(0.9 * part.edge(AROUND).min())
    assert (moved[inside] == unit[inside]).all()


def test_frame_is_a_rotation():
    frame = upright_frame(np.array([0.3, -0.5, 0.9]))
    assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-14)
    assert np.linalg.det(frame) == pytest.approx(1.0)
    assert upright_frame(np.array([0.0, 0.0, 2.0])) == pytest.approx(np.eye(3))


def test_curve_goes_part_of_the_way_in_a_step_and_is_restored(sheet):
    before, after = lying(sheet, 75.0, up=True), lying(sheet, 60.0, up=True)
    found = search(sheet)
    whole = search(sheet).free_part(after, 0.0).waves
    start = found.free_part(before, 0.0).waves
    saved = found.save()
    once = found.free_part(after, 0.01).waves
    assert once == pytest.approx(start + ContactSettings().share * (whole - start), abs=1e-12)
    other = search(sheet)
    other.restore(saved)
    assert (other.free_part(after, 0.01).waves == once).all()
    for _ in range(60):
        last = found.free_part(after, 0.01).waves
    assert last == pytest.approx(whole, abs=1e-12)
