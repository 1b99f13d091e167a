"""The tank's shape by the keys of [tank]: what each gives, and what is wrong with them."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from coupling.fluids.hydrostatic import Hydrostatic
from coupling.scene.scene import Scene, SceneError, load_scene
from coupling.store.scene_file import write_scene
from coupling.structure.diaphragm import diaphragm_of, settle_diaphragm

R = 0.4445
SCENE = """
[tank]
{tank}
[diaphragm]
material = "AF-E-332"
thickness = 0.001778
[liquid]
name = "water"
fill_fraction = 0.5
[model]
fluid = "hydrostatic"
[time]
duration = 0.1
"""


def scene(folder: Path, *tank: str, **changes: object) -> Scene:
    (folder / "scene.toml").write_text(SCENE.format(tank="\n".join(tank)))
    return load_scene(folder, changes)


def refused(folder: Path, *tank: str) -> str:
    with pytest.raises(SceneError) as error:
        scene(folder, *tank)
    (line,) = error.value.problems
    return line


def circle(count: int = 41) -> np.ndarray:
    """Points (n, 2) of a half circle of radius R, from the lower pole to the upper one."""
    angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, count)
    return R * np.column_stack([np.cos(angle), np.sin(angle)])


def write_profile(folder: Path, points: np.ndarray, header: str = "r,z") -> str:
    lines = [header, *(f"{r!r},{z!r}" for r, z in points.tolist())]
    (folder / "shell.csv").write_text("\n".join(lines))
    return 'profile = "shell.csv"'


def test_volumes_against_their_formulas(tmp_path: Path):
    """An ellipsoid's arcs lie within 1e-6 of its larger semi-axis, whose volume errs by less."""
    pill = scene(tmp_path, 'shape = "pill"', "radius = 0.2", "cylinder_length = 0.4").tank
    ball = 4.0 / 3.0 * math.pi * 0.2**3
    assert pill.volume == pytest.approx(ball + math.pi * 0.2**2 * 0.4, rel=1e-13)
    egg = scene(tmp_path, 'shape = "ellipsoid"', "radius = 0.2", "semi_axis = 0.14").tank
    assert egg.volume == pytest.approx(0.7 * ball, rel=3e-6)
    assert scene(
        tmp_path, 'shape = "ellipsoid"', "radius = 0.2", "semi_axis = 0.2"
    ).tank.volume == (pytest.approx(ball, rel=1e-13))


@pytest.mark.parametrize("at", [-0.12, 0.05])
def test_a_sphere_clamped_off_its_equator(tmp_path: Path, at: float):
    """The cap above the clamped circle, pi h^2 (R - h/3), and the circle's radius."""
    shell = scene(tmp_path, "radius = 0.2", f"clamp_height = {at}").tank.shell
    cap = math.pi * (0.2 - at) ** 2 * (0.2 - (0.2 - at) / 3.0)
    assert shell.volume - shell.volume_below(0.0) == pytest.approx(cap, rel=1e-12)
    assert shell.size == pytest.approx(math.sqrt(0.2**2 - at**2), rel=1e-14)
    assert shell.poles == pytest.approx((-0.2 - at, 0.2 - at), rel=1e-14)


@pytest.mark.parametrize("part", ["upper", "lower"])
def test_a_mould_is_the_shell_s_part(tmp_path: Path, part: str):
    keys = ("radius = 0.2", "cylinder_length = 0.4", "clamp_height = 0.1", 'shape = "pill"')
    made = scene(tmp_path, *keys, **{"diaphragm.mould": part})
    side, mould = (1.0 if part == "upper" else -1.0), made.mould
    cylinder = 0.2 - side * 0.1
    assert mould.length == pytest.approx(0.1 * math.pi + cylinder, rel=1e-13)
    assert mould.ring(0, 8) == pytest.approx((0.0, side * (0.2 + cylinder)))
    assert mould.ring(8, 8) == pytest.approx((0.2, 0.0))


def test_points_of_a_sphere_are_the_sphere(tmp_path: Path):
    """In either order, in another unit; its pieces are those of one circle, to rounding."""
    points = circle()
    for given, header in ((points, "r,z"), (points[::-1], "r,z"), (1e3 * points, "r [mm],z [mm]")):
        key = write_profile(tmp_path, given, header)
        shell = scene(tmp_path, 'shape = "profile"', key).tank.shell
        np.testing.assert_allclose(shell.profile[:, 4:6], 0.0, atol=1e-13)
        np.testing.assert_allclose(shell.profile[:, 6], R, rtol=1e-12)
        assert len(shell.profile) <= 3


def test_points_of_a_pill_are_the_pill_s_three_pieces(tmp_path: Path):
    """Points of arcs and of a line, the joints among them, give the arcs and the line."""
    half = 0.3
    quarter = circle(25)[:13] - [0.0, half]
    side = np.column_stack([np.full(5, R), np.linspace(-half, half, 7)[1:-1]])
    points = np.vstack([quarter, side, (quarter * [1.0, -1.0])[::-1]])
    key = write_profile(tmp_path, points)
    got = scene(tmp_path, 'shape = "profile"', key).tank.shell.profile
    wanted = scene(
        tmp_path, 'shape = "pill"', f"radius = {R}", f"cylinder_length = {2 * half}"
    ).tank.shell.profile
    np.testing.assert_allclose(got, wanted, atol=1e-12)


def test_points_of_an_ellipse_err_by_the_third_power_of_their_distance(tmp_path: Path):
    """Half the distance leaves an eighth of the error, beside the 1e-6 of the size of all arcs."""
    angle, errors = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 4001), []
    fine = np.column_stack([R * np.cos(angle), 0.0 * angle, 0.7 * R * np.sin(angle)])
    for count in (21, 41, 81):
        key = write_profile(tmp_path, circle(count) * [1.0, 0.7])
        shell = scene(tmp_path, 'shape = "profile"', key).tank.shell
        errors.append(np.abs(shell.gap(fine)).max() / R)
    assert errors[0] < 3e-5
    assert errors[1] < errors[0] / 8.0 + 1.5e-6
    assert errors[2] < 1.5e-6


def test_a_scene_s_copy_has_its_profile(tmp_path: Path):
    made = scene(tmp_path, 'shape = "profile"', write_profile(tmp_path, circle()))
    (tmp_path / "run").mkdir()
    write_scene(made, tmp_path / "run")
    (tmp_path / "shell.csv").unlink()
    again = load_scene(tmp_path / "run")
    np.testing.assert_array_equal(again.tank.shell.profile, made.tank.shell.profile)
    assert again.tank.profile == str(tmp_path / "run" / "profile.csv")


@pytest.mark.parametrize(
    ("keys", "says"),
    [
        (["cylinder_length = 0.1"], 'tank.radius: is required for shape = "pill"'),
        (["radius = 0.2"], 'tank.cylinder_length: is required for shape = "pill". Give the length'),
        (
            ["radius = 0.2", "cylinder_length = 0.1", "semi_axis = 0.1"],
            'tank.semi_axis: is read with tank.shape = "ellipsoid" only, got shape = "pill"',
        ),
        (
            ["radius = 0.2", "cylinder_length = 0.1", 'profile = "shell.csv"'],
            'tank.profile: is read with tank.shape = "profile" only, got shape = "pill"',
        ),
        (["radius = 0.2", "cylinder_length = -0.1"], "tank.cylinder_length: must not be negative"),
        (
            ["radius = 0.2", "cylinder_length = 0.1", "clamp_height = 0.25"],
            "tank.clamp_height: must lie between the shell's poles, in (-0.25, 0.25) m, got 0.25",
        ),
        (
            ["radius = 0.2", "cylinder_length = 0.1", "clamp_height = -0.2499"],
            "tank.clamp_height: at -0.2499 m the shell is 0.006324 m in radius, less than 0.1",
        ),
        (
            ["radius = 0.2", "cylinder_length = 6.0"],
            "cloth.resolution: rings of a diaphragm 3.314 m from pole to rim must lie within half",
        ),
        (
            ["radius = 0.2", "cylinder_length = 1e9"],
            "No grid is fine enough: give a shorter tank.",
        ),
    ],
)
def test_a_wrong_key_is_refused(tmp_path: Path, keys: list[str], says: str):
    assert says in refused(tmp_path, 'shape = "pill"', *keys)


def test_a_sphere_takes_no_other_key(tmp_path: Path):
    says = 'tank.cylinder_length: is read with tank.shape = "pill" only, got shape = "sphere"'
    assert says in refused(tmp_path, "radius = 0.2", "cylinder_length = 0.1")


def edged() -> np.ndarray:
    """A cylinder with flat cones for ends."""
    end = np.column_stack([np.linspace(0.0, 0.3, 6), np.linspace(-0.25, -0.2, 6)])
    return np.vstack([end, [[0.3, 0.0]], (end * [1.0, -1.0])[::-1]])


@pytest.mark.parametrize(
    ("points", "says"),
    [
        (circle(8), "holds 8 points, at least 9 are needed"),
        (circle() * [-1.0, 1.0], "r must not be negative"),
        (circle()[:-3], "line 39: the first and the last point must lie on the axis"),
        (
            circle()[[*range(20), 21, 20, *range(22, 41)]],
            "line 23: z must rise from point to point",
        ),
        (edged(), "line 7: the meridian turns by 81 degrees, at most 30 may be"),
    ],
)
def test_a_wrong_profile_is_refused(tmp_path: Path, points: np.ndarray, says: str):
    line = refused(tmp_path, 'shape = "profile"', write_profile(tmp_path, points))
    assert "tank.profile: " in line
    assert "shell.csv" in line
    assert says in line


def test_a_profile_that_is_not_there_is_refused(tmp_path: Path):
    line = refused(tmp_path, 'shape = "profile"', 'profile = "none.csv"')
    assert "tank.profile: " in line
    assert "none.csv" in line


def own_mould(folder: Path, height: float, radius: float = R) -> list[str]:
    """Keys of a sphere's diaphragm that is moulded to half an ellipsoid of this ``height``."""
    angle = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 81)
    points = np.column_stack([radius * np.cos(angle), height * np.sin(angle)])
    lines = ["r,z", *(f"{r!r},{z!r}" for r, z in points.tolist())]
    (folder / "mould.csv").write_text("\n".join(lines))
    return [f"radius = {R}", "[diaphragm]", 'mould_profile = "mould.csv"']


def moulded_scene(folder: Path, height: float, **changes: object) -> Scene:
    keys = own_mould(folder, height)
    text = SCENE.format(tank=keys[0]).replace("[diaphragm]", "\n".join(keys[1:]))
    (folder / "scene.toml").write_text(text)
    return load_scene(folder, changes)


def test_a_mould_of_its_own_that_is_the_shells_is_the_shells(tmp_path: Path):
    made, shell = moulded_scene(tmp_path, R), scene(tmp_path, f"radius = {R}")
    assert made.mould.length == pytest.approx(shell.mould.length, rel=1e-12)
    rings = [(made.mould.ring(k, 24), shell.mould.ring(k, 24)) for k in range(25)]
    np.testing.assert_allclose(*np.swapaxes(rings, 0, 1), atol=1e-12)


def test_a_run_has_a_copy_of_the_moulds_profile(tmp_path: Path):
    made = moulded_scene(tmp_path, 0.8 * R)
    (tmp_path / "run").mkdir()
    write_scene(made, tmp_path / "run")
    (tmp_path / "mould.csv").unlink()
    assert load_scene(tmp_path / "run").mould.length == made.mould.length


def test_a_shallow_mould_rests_level_and_holds_no_more_than_it_can(tmp_path: Path):
    """Half an ellipsoid 0.8 R high in a sphere: 0.8 of the upper half's volume either way.

    Level at half fill without tension, and the volume kept to rounding.
    """
    made = moulded_scene(tmp_path, 0.8 * R, **{"cloth.resolution": 10})
    least, largest = made.tank.held_by(made.mould, own=True)
    assert np.array([least, largest]) / made.tank.volume == pytest.approx([0.1, 0.9], abs=1e-4)
    cloth = diaphragm_of(made)
    load = Hydrostatic(density=1000.0).load(np.array(made.gravity), made.liquid_volume)
    assert settle_diaphragm(cloth, made, load) < 1e-6
    assert cloth.state.volume == pytest.approx(made.liquid_volume, rel=1e-12)
    assert np.abs(cloth.state.position[:, 2]).max() < 0.02 * R
    with pytest.raises(SceneError, match="moulded to the upper part of this profile holds fill"):
        moulded_scene(tmp_path, 0.8 * R, **{"liquid.fill_fraction": 0.95})


def test_a_mould_that_misses_the_rim_is_refused(tmp_path: Path):
    keys = own_mould(tmp_path, 0.8 * R, radius=0.9 * R)
    text = SCENE.format(tank=keys[0]).replace("[diaphragm]", "\n".join(keys[1:]))
    (tmp_path / "scene.toml").write_text(text)
    with pytest.raises(SceneError, match=r"must be 0\.4445 m in radius at z = 0"):
        load_scene(tmp_path)
