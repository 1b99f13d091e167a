"""How a tank turns: attitudes, what a lever adds, and records with rotation."""

from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coupling.motion.attitude import AngleAttitude, RateAttitude
from coupling.motion.frame import frame_of
from coupling.motion.lever import LeverMotion
from coupling.motion.record_summary import record_summary
from coupling.motion.sine import SineAttitude, SineMotion
from coupling.motion.table import TABLE
from coupling.scene.motion_file import read_motion_table
from coupling.scene.scene import SceneError, scene_from
from coupling.scene.tables.text import TableError

G = 9.80665
AXIS = np.array([0.2, 1.0, -0.3])
PITCH = SineAttitude(frequency=1.3, angle=0.4, axis=AXIS, ramp=1.0)
POINT = np.array([0.1, 0.2, -1.5])
HEAD = "time (s),ax (m/s^2),ay (m/s^2),az (m/s^2)"


def vee(matrix: np.ndarray) -> np.ndarray:
    """The vector w of the skew part of a matrix, w x v."""
    skew = 0.5 * (matrix - matrix.T)
    return np.array([skew[2, 1], skew[0, 2], skew[1, 0]])


def written(folder: Path, head: str, *columns: np.ndarray) -> Path:
    file = folder / "record.csv"
    rows = [",".join(f"{value:.15g}" for value in row) for row in np.column_stack(columns)]
    file.write_text(head + "\n" + "\n".join(rows) + "\n", encoding="utf-8")
    return file


def scene(motion: dict, duration: float = 1.0):
    return scene_from(
        {
            "tank": {"radius": 0.2}, "diaphragm": {"thickness": 0.0015, "material": "AF-E-332"},
            "liquid": {"name": "water", "fill_fraction": 0.8}, "motion": motion,
            "model": {"fluid": "hydrostatic"}, "time": {"duration": duration, "step": 0.01},
        }
    )  # fmt: skip


def still(count: int) -> np.ndarray:
    return np.zeros((count, 3))


@pytest.mark.parametrize(
    "attitude",
    [
        PITCH,
        RateAttitude(np.linspace(0.0, 2.0, 41), np.random.default_rng(1).normal(0.0, 0.3, (41, 3))),
        AngleAttitude(
            np.linspace(0.0, 2.0, 41),
            np.outer(np.sin(3.0 * np.linspace(0.0, 2.0, 41)), [0.3, 0.2, -0.5]),
        ),
    ],
)
def test_the_rate_is_that_of_the_attitude(attitude):
    """R' = R [omega], by central differences of 1e-5 s.

    They err by 1e-10/6 of the third derivative and 1e-16/1e-5; Magnus' expansion within 0.05 s by
    1e-6 of rates of 0.3 rad/s.
    """
    for time in (0.312, 0.61, 1.234):
        ahead, behind = attitude.matrix(time + 1e-5), attitude.matrix(time - 1e-5)
        rate = vee(attitude.matrix(time).T @ (ahead - behind) / 2e-5)
        np.testing.assert_allclose(rate, attitude.rate(time), atol=2e-6)
        np.testing.assert_allclose(ahead @ ahead.T, np.eye(3), atol=1e-14)
        slope = (attitude.rate(time + 1e-5) - attitude.rate(time - 1e-5)) / 2e-5
        np.testing.assert_allclose(slope, attitude.acceleration(time), atol=1e-6)


def test_rates_about_one_axis_are_integrated_exactly():
    time = np.array([0.0, 0.1, 0.35, 0.6, 1.0])
    size = np.array([0.0, 2.0, -1.0, 0.5, 3.0])
    axis = AXIS / np.linalg.norm(AXIS)
    angle = np.append(0.0, np.cumsum(0.5 * (size[1:] + size[:-1]) * np.diff(time)))
    attitude = RateAttitude(time, np.outer(size, axis))
    for at, turned in zip(time, angle, strict=True):
        wanted = Rotation.from_rotvec(turned * axis).as_matrix()
        np.testing.assert_allclose(attitude.matrix(at), wanted, atol=1e-14)


def test_a_coning_tank_is_integrated_to_the_fourth_order():
    """Rates of an axis that goes round, against 64 times as many: the error falls 16 fold."""

    def turned(count: int) -> np.ndarray:
        fine = np.linspace(0.0, 2.0, 641)
        time = np.linspace(0.0, 2.0, count)
        coning = np.column_stack([np.cos(5.0 * fine), np.sin(5.0 * fine), 0.0 * fine + 0.5])
        # The line between samples of the coarse time is part of the record: take it from one.
        line = np.column_stack([np.interp(fine, fine[::16], part[::16]) for part in coning.T])
        chosen = np.column_stack([np.interp(time, fine, part) for part in line.T])
        return RateAttitude(time, chosen).matrix(2.0)

    exact = turned(641)
    errors = [np.abs(turned(count) - exact).max() for count in (41, 81)]
    assert errors[0] < 1e-4
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.3)


def test_angles_are_yaw_then_pitch_then_roll():
    time = np.linspace(0.0, 1.0, 11)
    angles = np.tile([0.1, 0.2, 0.3], (11, 1))

    def about(axis: int, angle: float) -> np.ndarray:
        return Rotation.from_rotvec(angle * np.eye(3)[axis]).as_matrix()

    wanted = about(2, 0.3) @ about(1, 0.2) @ about(0, 0.1)
    np.testing.assert_allclose(AngleAttitude(time, angles).matrix(0.4), wanted, atol=1e-14)


def test_a_lever_moves_the_middle_as_the_differences_of_its_way():
    """Central differences of 1e-4 s err by 1e-8/6 of the third and fourth derivative, 1e3."""
    swaying = SineMotion(frequency=1.3, amplitude=0.05, direction=AXIS, ramp=1.0)
    motion = LeverMotion(swaying, PITCH, POINT)
    for time in (0.4, 1.1):
        around = [motion.displacement(time + k * 1e-4) for k in (-1, 0, 1)]
        velocity = (around[2] - around[0]) / 2e-4
        np.testing.assert_allclose(velocity, motion.velocity(time), atol=1e-5)
        second = (around[2] - 2.0 * around[1] + around[0]) / 1e-8
        np.testing.assert_allclose(second, motion.acceleration(time), atol=1e-4)


class Moved:
    """The way of the middle of a tank that pitches about a distant axis, written out."""

    def __init__(self, frequency: float, angle: float, height: float) -> None:
        self.omega, self.angle, self.height = 2.0 * np.pi * frequency, angle, height

    def _turned(self, time: float) -> tuple[float, float, float]:
        one = self.omega * time
        return (
            self.angle * np.sin(one),
            self.angle * self.omega * np.cos(one),
            -self.angle * self.omega**2 * np.sin(one),
        )

    def displacement(self, time: float) -> np.ndarray:
        angle, _, _ = self._turned(time)
        return self.height * np.array([np.sin(angle), 0.0, np.cos(angle) - 1.0])

    def velocity(self, time: float) -> np.ndarray:
        angle, first, _ = self._turned(time)
        return self.height * first * np.array([np.cos(angle), 0.0, -np.sin(angle)])

    def acceleration(self, time: float) -> np.ndarray:
        angle, first, second = self._turned(time)
        along, across = np.array([np.cos(angle), 0.0, -np.sin(angle)]), np.array([1.0, 0.0, 0.0])
        inward = -np.sin(angle) * across - np.cos(angle) * np.array([0.0, 0.0, 1.0])
        return self.height * (second * along + first**2 * inward)

    def step_acceleration(self, start: float, end: float, previous: float) -> np.ndarray:
        return self.acceleration(end)

    def working_acceleration(self, start: float, end: float) -> np.ndarray:
        return 0.5 * (self.acceleration(start) + self.acceleration(end))


def test_pitch_about_a_distant_axis_is_a_translation_and_a_rotation():
    """Of the middle of the tank, 1.5 m above the axis: the same body force, to rounding."""
    pitch = {"kind": "sine", "frequency": 0.8, "angle": 12.0, "ramp": 0.0}
    frame = frame_of(scene(pitch | {"point": [0.0, 0.0, -1.5]}))
    turned = frame_of(scene(pitch))
    moved = Moved(0.8, np.radians(12.0), 1.5)
    for start in (0.0, 0.13, 0.77):
        end = start + 0.01
        force = turned.gravity - moved.step_acceleration(start, end, 0.01)
        wanted = turned.in_tank(force, end)
        np.testing.assert_allclose(frame.body_force(start, end, 0.01), wanted, rtol=1e-13)
        np.testing.assert_allclose(
            frame.displacement(end), moved.displacement(end), atol=1e-14, rtol=1e-13
        )
        work = moved.working_acceleration(start, end)
        np.testing.assert_allclose(frame.working_acceleration(start, end), work, rtol=1e-12)
        np.testing.assert_array_equal(frame.rate(end), turned.rate(end))


def test_a_logger_on_a_tank_that_only_tilts_shows_gravity_alone(tmp_path: Path):
    """What it measured turned back, less gravity, is nothing, but for 15 digits in the file."""
    time = np.linspace(0.0, 1.0, 201)
    angles = np.degrees(0.4 * np.sin(4.0 * time))
    shown = [
        G * Rotation.from_euler("Y", angle, degrees=True).as_matrix().T @ [0.0, 0.0, 1.0]
        for angle in angles
    ]
    none = np.zeros_like(time)
    file = written(
        tmp_path, HEAD + ",roll (deg),pitch (deg),yaw (deg)", time, np.array(shown), none, angles,
        none,
    )  # fmt: skip
    made = scene({"kind": "table", "file": str(file), "at_rest": [0.0, 0.0, G]})
    frame = frame_of(made)
    assert np.abs(TABLE.record(made.motion).acceleration).max() < 1e-13 * G
    np.testing.assert_allclose(
        frame.body_force(0.2, 0.21, 0.01), frame.in_tank(frame.gravity, 0.21), atol=1e-10
    )


def test_a_record_of_a_lorry_that_pitches_about_its_logger(tmp_path: Path):
    """Samples of a sine's accelerations and rates at its axis: the sine itself, but for lines.

    A line between samples of 1 ms misses 1e-6/8 of the second derivative, omega^2 of the sine's
    size. The mean over a step h, carried to its end, is the steps' own difference of the velocity,
    off by (omega h)^2/3 of the acceleration, 0.13 %, and by as much again in the smooth start.
    """
    pitch = SineAttitude(frequency=1.0, angle=0.1, axis=np.array([0.0, 1.0, 0.0]), ramp=1.0)
    time = np.linspace(0.0, 2.0, 2001)
    rates = np.degrees([pitch.rate(t) for t in time])
    file = written(
        tmp_path, HEAD + ",gyro x [dps],gyro y [dps],gyro z [dps]", time, still(2001), rates
    )
    point = [0.0, 0.0, -1.5]
    sampled = frame_of(scene({"kind": "table", "file": str(file), "point": point}, 2.0))
    sine = frame_of(
        scene(
            {"kind": "sine", "frequency": 1.0, "angle": np.degrees(0.1), "point": point}, 2.0
        )
    )  # fmt: skip
    for time in (0.5, 1.2, 1.9):
        np.testing.assert_allclose(sampled.attitude(time), sine.attitude(time), atol=1e-6)
        np.testing.assert_allclose(sampled.displacement(time), sine.displacement(time), atol=1e-6)
        given = sampled.body_force(time, time + 0.01, 0.01)
        wanted = sine.body_force(time, time + 0.01, 0.01)
        assert np.abs(given - wanted).max() < 2.6e-3 * 0.15 * (2.0 * np.pi) ** 2


@pytest.mark.parametrize(
    ("head", "columns", "says"),
    [
        (HEAD + ",wx (deg/s),wy (deg/s)", 2, "names no column wz"),
        (HEAD + ",pitch (deg)", 1, "names no column roll, yaw"),
        (HEAD + ",wx,wy,wz", 3, "gives no unit of wx, wy, wz"),
        (HEAD + ",wx (deg),wy (deg/s),wz (deg/s)", 3, "unit 'deg' of wx is not known"),
        (HEAD + ",wx (deg/s),pitch (deg)", 2, "angular rates and angles"),
    ],
)
def test_rotation_that_is_not_whole_is_refused(tmp_path: Path, head: str, columns: int, says: str):
    time = np.linspace(0.0, 1.0, 11)
    file = written(tmp_path, head, time, still(11), np.zeros((11, columns)))
    with pytest.raises(TableError, match=r"line 1.*" + says):
        read_motion_table(file)


def test_units_of_rotation_are_those_of_the_header(tmp_path: Path):
    time, rates = np.linspace(0.0, 1.0, 11), np.tile([0.1, -0.2, 0.3], (11, 1))
    radians = read_motion_table(
        written(tmp_path, HEAD + ",wx (rad/s),wy (rad/s),wz (rad/s)", time, still(11), rates)
    )
    np.testing.assert_allclose(radians.rates, rates, rtol=1e-14)
    assert "wx [rad/s]" in radians.read
    degrees = read_motion_table(
        written(tmp_path, HEAD + ",omega_x_deg/s,omega_y_deg/s,omega_z_deg/s", time, still(11),
                np.degrees(rates))
    )  # fmt: skip
    np.testing.assert_allclose(degrees.rates, rates, rtol=1e-14)


def refused(motion: dict) -> str:
    with pytest.raises(SceneError) as error:
        scene(motion)
    return str(error.value)


def test_a_sine_needs_an_amplitude_or_an_angle_and_an_axis(tmp_path: Path):
    sine = {"kind": "sine", "frequency": 1.0}
    assert "motion.amplitude: is required" in refused(sine)
    assert "motion.axis: must not be zero" in refused(sine | {"angle": 5.0, "axis": [0.0] * 3})
    assert "motion.angle" in refused(sine | {"angle": 90.0})
    sway = sine | {"amplitude": 0.01}
    assert "motion.point: is read beside an angle only" in refused(sway | {"point": [0.0, 1.0, 0]})
    assert "motion.axis: is read beside an angle only" in refused(sway | {"axis": [1.0, 0.0, 0.0]})
    time = np.linspace(0.0, 2.0, 11)
    file = written(tmp_path, HEAD, time, still(11))
    table = {"kind": "table", "file": str(file)}
    assert "motion.angle: is read with" in refused(table | {"angle": 5.0})
    over = written(tmp_path, HEAD + ",wx (rad/s),wy (rad/s),wz (rad/s)", time, still(11),
                   np.tile([2.0, 0.0, 0.0], (11, 1)))  # fmt: skip
    assert "turns the tank by 90 degrees or more, first at 0.8 s" in refused(
        {"kind": "table", "file": str(over)}
    )


def test_the_thesis_grid_turns_no_tank():
    """A sine about an axis with it is refused before anything starts."""
    data = {
        "tank": {"radius": 0.4445}, "diaphragm": {"thickness": 0.0018, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.8}, "model": {"fluid": "datum"},
        "cloth": {"grid": "thesis", "resolution": 26}, "time": {"duration": 0.1, "step": 0.001},
        "motion": {"kind": "sine", "frequency": 1.0, "amplitude": 0.01},
    }  # fmt: skip
    assert scene_from(data).motion.angle is None
    with pytest.raises(SceneError, match=r'cloth.grid: "thesis" computes no tank that turns'):
        scene_from(data | {"motion": data["motion"] | {"angle": 5.0}})


def test_what_is_known_of_a_record_says_how_far_it_turns(tmp_path: Path):
    """0.2 rad/s about x and y for 0.505 s, as the lines have it: 0.1428 rad, all of it a tilt."""
    time = np.linspace(0.0, 1.0, 101)
    rates = np.outer(np.where(time <= 0.5, 0.2, 0.0), [1.0, 1.0, 0.0])
    file = written(tmp_path, HEAD + ",wx (rad/s),wy (rad/s),wz (rad/s)", time, still(101), rates)
    summary = record_summary(scene({"kind": "table", "file": str(file)}))
    assert summary is not None
    assert "it turns the tank by up to 8.18 degrees, and tilts it by up to 8.18" in summary.says
