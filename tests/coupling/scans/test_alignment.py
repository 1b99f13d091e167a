"""Scans with 0.8 mm of noise, holes, 5 mm and 3 degrees of misalignment find their way back."""

from __future__ import annotations

import numpy as np
import pytest
import scanned_sheets as sheets
from scipy.spatial.transform import Rotation

from coupling.scans.alignment import Alignment, align
from coupling.scans.pose import Pose, names_known
from coupling.scans.sampling_error import blocks_of, mean_error
from coupling.scans.sheet import Sheet
from foam_cases.steady_shapes.made_scan import MadeScan, made_scan

SHIFT, TURN = 0.2e-3, 0.1  # m and degrees: what is asked for


def errors(found: Alignment, scan: MadeScan, start: Pose | None = None) -> tuple[float, float]:
    """How far off [m] and [degrees] an alignment is, of a scan that was moved by ``start``, too."""
    rotation, shift = scan.rotation, scan.shift
    if start is not None:
        rotation, shift = rotation @ start.rotation.T, shift
    turn = Rotation.from_matrix(found.pose.rotation @ rotation.T).magnitude()
    return float(np.linalg.norm(found.pose.shift - shift)), float(np.degrees(turn))


@pytest.mark.parametrize(("seed", "azimuth"), [(0, 0.0), (1, 115.0), (2, -40.0)])
def test_a_folded_diaphragm_is_found_at_any_azimuth(seed: int, azimuth: float) -> None:
    """12 folds: at 30 degrees from the right azimuth another minimum looks much alike."""
    sheet = sheets.settled()
    scan, start = (
        made_scan(sheet.nodes, sheet.triangles, seed, number=3000),
        Pose.turned(np.radians(azimuth)),
    )
    found = align(sheet, start.moved(scan.points), sheets.RADIUS)
    shift, turn = errors(found, scan, start)
    assert shift < SHIFT
    assert turn < TURN
    assert all(names_known(found.basis).values())
    assert found.left < 1e-6 * sheets.RADIUS
    assert not found.as_good


def test_half_of_a_folded_diaphragm_is_enough() -> None:
    sheet = sheets.settled()
    scan = made_scan(sheet.nodes, sheet.triangles, 3, number=5000)
    part = scan.points[scan.points[:, 0] > 0.05]
    shift, turn = errors(align(sheet, part, sheets.RADIUS), scan)
    assert shift < SHIFT
    assert turn < TURN


@pytest.mark.parametrize(
    ("sheet", "unknown"),
    [
        (sheets.bowl(), {"azimuth"}),
        (sheets.sphere(), {"tilt_x", "tilt_y", "azimuth"}),
        # nearly a part of a sphere, which turns about its own centre
        (sheets.bowl(order=2.0), {"shift_x", "shift_y", "tilt_x", "tilt_y", "azimuth"}),
        (sheets.bowl(depth=0.0), {"shift_x", "shift_y", "azimuth"}),
    ],
)
def test_a_surface_that_moves_in_itself_has_no_such_motion(sheet: Sheet, unknown: set[str]) -> None:
    """Though its triangles have one: a scan of the grid differs from one of the surface."""
    scan = made_scan(sheet.nodes, sheet.triangles, 0, number=2000)
    found = align(sheet, scan.points, sheets.RADIUS)
    assert {name for name, known in names_known(found.basis).items() if not known} == unknown
    assert abs(found.pose.azimuth) < np.radians(0.5)  # it is not turned for nothing


def test_the_motion_is_as_sure_as_it_says() -> None:
    """Of 16 x 5 squared ratios to the standard error the mean is 1 within 4 times sqrt(2/80)."""
    sheet, ratios = sheets.bowl(), []
    for seed in range(16):
        axis = np.array([np.cos(seed), np.sin(seed), 0.0])
        scan = made_scan(sheet.nodes, sheet.triangles, seed, number=1500, holes=1, axis=axis)
        found = align(sheet, scan.points, sheets.RADIUS)
        left = Pose(rotation=found.pose.rotation @ scan.rotation.T, shift=np.zeros(3))
        off = np.concatenate([found.pose.shift - scan.shift, sheets.RADIUS * left.tilt])
        blocks = blocks_of(scan.points)
        error = [mean_error(each, blocks) for each in found.influence.T[:5]]
        ratios += list((off / error) ** 2)
    assert np.mean(ratios) == pytest.approx(1.0, abs=4.0 * np.sqrt(2.0 / len(ratios)))


def test_of_equal_azimuths_the_least_turn_is_taken_and_the_others_are_said() -> None:
    """Three equal lobes: the same at every third of a turn, on a grid that is not."""
    bowl = sheets.bowl()
    nodes = bowl.nodes.copy()
    out = np.hypot(nodes[:, 0], nodes[:, 1]) / sheets.RADIUS
    lobes = np.cos(3.0 * np.arctan2(nodes[:, 1], nodes[:, 0]))
    nodes[:, 2] += 0.06 * out**2 * (1.0 - out**2) * lobes
    sheet = Sheet(nodes, bowl.triangles)
    scan = made_scan(nodes, bowl.triangles, 0, number=1500, noise=3e-3, holes=0)
    found = align(sheet, scan.points, sheets.RADIUS)
    assert abs(np.degrees(found.pose.azimuth)) < 4.0
    assert np.degrees(np.sort(found.as_good)) == pytest.approx([-120.0, 120.0], abs=5.0)


def test_a_pose_is_taken_apart_into_azimuth_and_tilt() -> None:
    azimuth, tilt = 2.0, np.array([0.1, -0.2])
    level = Rotation.from_rotvec([*tilt, 0.0]).as_matrix()
    pose = Pose(rotation=level @ Pose.turned(azimuth).rotation, shift=np.zeros(3))
    assert pose.azimuth == pytest.approx(azimuth, abs=1e-14)
    assert pose.tilt == pytest.approx(tilt, abs=1e-14)
