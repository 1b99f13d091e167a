"""Thickness maps: read, interpolated, averaged, and carried into the scene and its cloth."""

from pathlib import Path

import numpy as np
import pytest

from coupling.estimate.numbers import numbers_of
from coupling.scene.content import content_of
from coupling.scene.scene import SceneError, load_scene, with_overrides
from coupling.scene.tables.text import TableError
from coupling.scene.thickness_map import ThicknessMap, read_thickness_map
from coupling.store.scene_file import write_scene
from coupling.structure.diaphragm import diaphragm_of

RADIUS = 0.4445
SCENE = """\
[tank]
radius = 0.4445
[diaphragm]
material = "AF-E-332"
thickness_map = "ridges.csv"
[liquid]
name = "water"
fill_fraction = 0.8
[model]
fluid = "hydrostatic"
[cloth]
resolution = 10
[time]
duration = 0.1
"""
RIDGES = """\
polar, azimuth, thickness
0, 0, 0.002
0, 90, 0.002
30, 0, 0.003
30, 90, 0.001
90, 90, 0.001
90, 0, 0.004
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    case = tmp_path / "ridged"
    case.mkdir()
    (case / "scene.toml").write_text(SCENE)
    (case / "ridges.csv").write_text(RIDGES)
    return case


def towards(polar: float, azimuth: float, length: float = 1.0) -> np.ndarray:
    p, a = np.radians([polar, azimuth])
    return length * np.array([[np.sin(p) * np.cos(a), np.sin(p) * np.sin(a), np.cos(p)]])


@pytest.mark.parametrize(
    ("polar", "azimuth", "thickness"),
    [
        (0, 0, 0.002),
        (30, 90, 0.001),
        (90, 0, 0.004),
        (15, 0, 0.0025),
        (15, 90, 0.0015),
        (30, 45, 0.002),
        (60, 45, 0.00225),  # the middle of a cell: the mean of its corners
        (30, 225, 0.002),  # on the way back from 90 to 360 degrees
        (30, 359.9999, 0.003),
        (30, -135, 0.002),
        (90.1, 0, 0.004),
    ],
)
def test_linear_between_and_closed_round_the_axis(folder, polar, azimuth, thickness):
    ridges = read_thickness_map(folder / "ridges.csv")
    assert ridges.at(towards(polar, azimuth, 0.3)) == pytest.approx(thickness, rel=1e-5)


def test_a_single_azimuth_is_the_same_all_round(tmp_path: Path):
    (tmp_path / "t.csv").write_text("0,7,0.001\n90,7,0.003\n")
    ridges = read_thickness_map(tmp_path / "t.csv")
    points = np.concatenate([towards(45, azimuth) for azimuth in (0, 100, 200, 300)])
    np.testing.assert_allclose(ridges.at(points), 0.002, rtol=1e-14)
    # t = 1 + 2 theta/(pi/2), and the integral of theta sin(theta) over [0, pi/2] is 1.
    assert ridges.mean == pytest.approx(1e-3 + 2e-3 * 2 / np.pi, rel=1e-14)


def test_the_mean_is_that_of_the_interpolated_map():
    seed = np.random.default_rng(3)
    azimuth = np.array([0.3, 1.0, 4.0])
    polar = np.array([0.0, 0.2, 1.1, np.pi / 2])
    ridges = ThicknessMap(polar=polar, azimuth=azimuth, thickness=seed.uniform(1, 2, (4, 3)))
    cosine = (np.arange(400) + 0.5) / 400  # equal areas
    phi = 2 * np.pi * (np.arange(400) + 0.5) / 400
    c, a = (grid.ravel() for grid in np.meshgrid(cosine, phi))
    s = np.sqrt(1 - c**2)
    sampled = ridges.at(np.column_stack([s * np.cos(a), s * np.sin(a), c])).mean()
    assert ridges.mean == pytest.approx(sampled, rel=1e-5)  # O(1/400^2), kinks included


def test_a_map_is_read_by_the_names_and_units_of_its_header(tmp_path: Path):
    text = "Thickness [mm];Azimuth (deg);Polar (rad)\n1,5;0;0\n2,5;0;1,5707963267948966\n"
    (tmp_path / "t.csv").write_text(text)
    ridges = read_thickness_map(tmp_path / "t.csv")
    np.testing.assert_allclose(ridges.at(towards(45, 10)), 0.002, rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("0,0,0.001\n90,0\n", r"line 2: must hold three finite numbers polar, azimuth, thick"),
        ("0,0,0.001\n90,0,thin\n", "line 2: must hold three finite numbers"),
        ("0,0,0.001\n", r"holds 1 lines.*polar, azimuth, thickness \(degrees, degrees, m\)"),
        ("thickness,azimuth\n1,2\n1,2\n", "line 1: names no column polar, got 'thickness, azim"),
        ("0,0,0.001\n91,0,0.001\n", r"line 2: polar must lie in \[0, 90\], got 91\. Give degrees"),
        ("0,0,1\n90,0,1\n0,360,1\n90,360,1\n", r"line 3: azimuth must lie in .* got 360\. Leave"),
        ("0,0,0.001\n# rim\n90,0,0\n", r"line 3: thickness must be positive, got 0\. Give"),
        ("0,0,0.001\n1.5708,0,0.001\n", "must cover 0 to 90 degrees, covers 0 to 1.5708"),
        ("5,0,0.001\n90,0,0.001\n", "must cover 0 to 90 degrees, covers 5 to 90"),
        ("0,0,1\n90,0,1\n0,90,1\n", "polar 90, azimuth 90 is missing, and 0 more. Give every"),
        ("0,0,1\n90,0,1\n90.0,0,2\n", "line 3: polar 90, azimuth 0 is given again, first in li"),
        ("0,0,1\n0,9,2\n90,0,1\n90,9,1\n", "line 2: the pole is one point.* got 2 after 1"),
    ],
)
def test_a_wrong_map_is_refused_with_its_line(tmp_path: Path, text: str, says: str):
    file = tmp_path / "t.csv"
    file.write_text(text)
    with pytest.raises(TableError, match=says) as caught:
        read_thickness_map(file)
    assert str(caught.value).startswith(str(file))


def test_the_cloth_is_as_thick_as_the_map_says(folder: Path):
    scene = load_scene(folder, ["cloth.resolution=20"])
    cloth = diaphragm_of(scene)
    ridges = read_thickness_map(folder / "ridges.csv")
    centroid = cloth.reference[cloth.triangles].mean(axis=1)
    # the places go through the mould's chart and back, to rounding
    np.testing.assert_allclose(cloth.thickness, ridges.at(centroid), rtol=1e-14)
    assert np.ptp(cloth.thickness) > 0.002
    # The inscribed triangles' area is O(h^2) short of the hemisphere's; h = pi/40.
    area = 2 * np.pi * RADIUS**2
    expected = scene.diaphragm.density * ridges.mean * area
    assert cloth.mass.sum() == pytest.approx(expected, rel=(np.pi / 40) ** 2)
    # Without a map it is the same all over.
    even = diaphragm_of(load_scene(folder, ["diaphragm.thickness=0.001"]))
    np.testing.assert_array_equal(even.thickness, 0.001)


def test_the_map_stands_for_the_thickness(folder: Path):
    scene = load_scene(folder)
    ridges = read_thickness_map(folder / "ridges.csv")
    assert scene.diaphragm.thickness == ridges.mean
    assert scene.diaphragm.thickness_range == (0.001, 0.004)
    even = load_scene(folder, ["diaphragm.thickness=0.001"])
    assert even.diaphragm.thickness_map is None
    assert even.diaphragm.thickness_range == (0.001, 0.001)
    again = with_overrides(even, [f"diaphragm.thickness_map={folder / 'ridges.csv'}"])
    assert again == scene
    assert with_overrides(scene, ["tank.radius=0.5"]).diaphragm == scene.diaphragm


def test_wrinkles_are_judged_where_the_rubber_is_thinnest(folder: Path):
    ridged = numbers_of(load_scene(folder))
    thin = numbers_of(load_scene(folder, ["diaphragm.thickness=0.001"]))
    assert ridged.elasto_gravity_wavelength == pytest.approx(thin.elasto_gravity_wavelength)
    assert ridged.rings_to_resolve == thin.rings_to_resolve
    assert ridged.added_mass_ratio < thin.added_mass_ratio  # of the mean thickness


def test_a_ridged_run_can_be_run_again_from_its_folder(folder: Path, tmp_path: Path):
    scene, run = load_scene(folder), tmp_path / "run"
    run.mkdir()
    write_scene(scene, run)
    moved = run.rename(tmp_path / "moved")
    text = (moved / "scene.toml").read_text()
    assert 'thickness_map = "thickness.csv"' in text
    assert "thickness = " not in text
    again = load_scene(moved)
    assert again.diaphragm.thickness == scene.diaphragm.thickness
    assert content_of(again) == content_of(scene)
    assert again != scene  # it lies elsewhere
    write_scene(again, moved)  # over itself: the map stays
    assert load_scene(moved) == again
    (folder / "ridges.csv").write_text(RIDGES.replace("0.004", "0.003"))
    assert content_of(again) != content_of(load_scene(folder))


def test_both_tables_are_copied_whatever_they_are_called(folder: Path):
    """Each has the name of the other's copy."""
    (folder / "ridges.csv").rename(folder / "motion.csv")
    (folder / "thickness.csv").write_text("0,0,0,0\n1,3,0,0\n")
    text = SCENE.replace("ridges.csv", "motion.csv")
    text += '[motion]\nkind = "table"\nfile = "thickness.csv"\n'
    (folder / "scene.toml").write_text(text)
    write_scene(load_scene(folder), folder)
    assert (folder / "thickness.csv").read_text() == RIDGES
    assert (folder / "motion.csv").read_text().startswith("0,0,0,0")


@pytest.mark.parametrize(
    ("change", "override", "says"),
    [
        (("ridges.csv", "no.csv"), "", "diaphragm.thickness_map: {folder}/no.csv: cannot be read"),
        (
            ("thickness_map", "thickness = 0.001\nthickness_map"),
            "",
            "diaphragm.thickness: is the mean of thickness_map, got 0.001 beside it. Leave one",
        ),
        (("[tank]", "[tank]"), "diaphragm.thickness_map=3", "must be text in quotes, got 3"),
        (
            ('thickness_map = "ridges.csv"', ""),
            "",
            "diaphragm.thickness: is required. Give the thickness of the rubber [m], below 0.05 "
            "radii, or a thickness_map.",
        ),
        (
            ("0.4445", "0.08"),
            "",
            "diaphragm.thickness_map: must be below 0.05 radii (0.004 m), got 0.004. Give metres",
        ),
        (
            ("hydrostatic", "datum"),
            "cloth.grid=thesis",
            'diaphragm.thickness_map: does not apply to cloth.grid = "thesis"',
        ),
    ],
)
def test_a_map_that_a_scene_cannot_use(folder: Path, change, override: str, says: str):
    file = folder / "scene.toml"
    file.write_text(SCENE.replace(*change).replace("resolution = 10", ""))
    with pytest.raises(SceneError) as caught:
        load_scene(folder, [override] if override else [])
    assert says.format(folder=folder) in str(caught.value)
