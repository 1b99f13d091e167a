"""The tank's motion: its derivatives, its smooth start, its tables."""

from pathlib import Path

import numpy as np
import pytest

from cloth.kinematics import kinematics
from coupling.motion.shaking import motion_of
from coupling.motion.sine import SineMotion, smooth_ramp
from coupling.motion.table import TableMotion
from coupling.scene.motion_file import read_motion_table
from coupling.scene.motion_table import MotionTable
from coupling.scene.scene import scene_from
from coupling.scene.tables.text import TableError

MINIMAL = {
    "tank": {"radius": 0.4445},
    "diaphragm": {"thickness": 0.001778, "material": "AF-E-332"},
    "liquid": {"name": "water", "fill_fraction": 0.8},
    "time": {"duration": 1.0},
}


def sine(ramp: float = 1.0) -> SineMotion:
    return SineMotion(
        frequency=1.25, amplitude=0.25, direction=np.array([1.0, 2.0, -2.0]), ramp=ramp
    )


def difference_errors(value, derivative, time):
    """Error of the central difference at three halved steps."""
    exact = derivative(time)
    return [
        float(np.abs((value(time + h) - value(time - h)) / (2 * h) - exact).max())
        for h in (1e-2, 5e-3, 2.5e-3)
    ]


@pytest.mark.parametrize("time", [0.11, 0.37, 0.63, 1.9])
@pytest.mark.parametrize("pair", [("displacement", "velocity"), ("velocity", "acceleration")])
def test_sine_derivatives_agree_with_differences_to_second_order(pair, time):
    motion = sine()
    errors = difference_errors(getattr(motion, pair[0]), getattr(motion, pair[1]), time)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Central differences err by h^2 f'''/6; higher terms are below 1 % of it at these steps.
    assert orders == pytest.approx([2.0, 2.0], abs=0.05)


def test_sine_runs_at_full_amplitude_along_the_unit_direction_after_the_ramp():
    motion = sine()
    quarter = 0.8 * 2.25  # two and a quarter periods
    expected = 0.25 * np.array([1.0, 2.0, -2.0]) / 3.0
    assert motion.displacement(quarter) == pytest.approx(expected, rel=1e-13)
    w = 2 * np.pi * 1.25
    assert motion.acceleration(quarter) == pytest.approx(-(w**2) * expected, rel=1e-12)


def test_sine_starts_from_rest_with_no_jump_in_acceleration():
    motion = sine()
    for h in (1e-3, 1e-4):
        # x = A 10 (t/T)^3 w t to leading order: the acceleration starts as 120 A w (t/T)^2 / T.
        leading = 0.25 * 10 * 12 * (2 * np.pi * 1.25) * h**2 / 0.8**3
        assert np.linalg.norm(motion.acceleration(h)) == pytest.approx(leading, rel=10 * h)
    for time in (0.0, -1.0):
        assert not motion.acceleration(time).any()
        assert not motion.displacement(time).any()
    seam = motion.acceleration(0.8 + 1e-9) - motion.acceleration(0.8 - 1e-9)
    # Continuous at the end of the ramp: differs by 2e-9 s times the jerk, below 1e4 m/s^3.
    assert np.abs(seam).max() < 2e-5


def test_without_a_ramp_the_sine_is_pure():
    motion = sine(ramp=0.0)
    w = 2 * np.pi * 1.25
    assert motion.velocity(0.0) == pytest.approx(0.25 * w * np.array([1, 2, -2]) / 3)


def test_ramp_is_a_half_in_the_middle_and_antisymmetric_about_it():
    assert smooth_ramp(1.0, 2.0)[0] == pytest.approx(0.5, rel=1e-15)
    assert smooth_ramp(0.3, 2.0)[0] + smooth_ramp(1.7, 2.0)[0] == pytest.approx(1.0, rel=1e-14)
    assert smooth_ramp(2.0, 2.0) == (1.0, 0.0, 0.0)


def test_table_integrates_its_acceleration_exactly():
    time, slope = np.linspace(-0.5, 2.0, 6), np.array([2.0, 0.0, -1.0])
    start = np.array([0.0, 3.0, 0.0])
    table = MotionTable(time=time, acceleration=np.outer(time, slope) + start)
    motion = TableMotion(table)
    t = 1.3
    # A straight line: velocity a t^2/2 + b t, displacement a t^3/6 + b t^2/2.
    assert motion.acceleration(t) == pytest.approx([2 * t, 3.0, -t], rel=1e-13)
    assert motion.velocity(t) == pytest.approx([t**2, 3 * t, -(t**2) / 2], rel=1e-13)
    assert motion.displacement(t) == pytest.approx([t**3 / 3, 1.5 * t**2, -(t**3) / 6], rel=1e-12)
    assert not motion.displacement(0.0).any()


def test_table_derivatives_agree_with_differences():
    time = np.linspace(0.0, 2.0, 41)
    wave = np.sin(5.0 * time)
    motion = TableMotion(MotionTable(time=time, acceleration=np.column_stack([wave] * 3)))
    errors = difference_errors(motion.displacement, motion.velocity, 1.025)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    # Between two knots (0.025 s away) the displacement is a cubic: second order exactly.
    assert orders == pytest.approx([2.0, 2.0], abs=0.05)
    # The velocity is quadratic there: exact up to rounding.
    assert max(difference_errors(motion.velocity, motion.acceleration, 1.025)) < 1e-11


def random_table() -> MotionTable:
    """Rough, at uneven times."""
    seed = np.random.default_rng(7)
    time = np.append(0.0, np.cumsum(seed.uniform(0.0005, 0.004, 400)))
    return MotionTable(time=time, acceleration=seed.normal(0.0, 20.0, (401, 3)))


def test_a_step_changes_the_velocity_of_a_free_body_by_the_integral_of_the_table():
    """Whatever the steps: whole ones, halved ones, and the first, which is Euler's."""
    motion = TableMotion(random_table())
    x = v = x0 = v0 = np.zeros(3)
    now, previous = 0.0, 0.0
    for dt in [0.01] * 5 + [0.005, 0.0025, 0.0025, 0.01] + [0.005] * 6:
        a = motion.step_acceleration(now, now + dt, previous)
        kin = kinematics(dt, previous, x, v, x0, v0)
        x0, v0 = x, v
        v = kin.velocity_anchor + kin.b * a
        x = kin.position_anchor + kin.b * v
        now, previous = now + dt, dt
        np.testing.assert_allclose(v, motion.velocity(now), rtol=1e-9, atol=1e-12)


def test_a_table_of_a_sine_drives_a_step_as_the_sine_does_to_second_order():
    """The mean over a step, used at its end, would be late by half a step: of first order."""
    exact, time = sine(), np.linspace(0.0, 3.0, 6001)
    motion = TableMotion(
        MotionTable(time=time, acceleration=np.array([exact.acceleration(t) for t in time]))
    )
    errors = []
    for dt in (0.02, 0.01, 0.005):
        ends = np.arange(2, round(2.5 / dt)) * dt
        found = np.array([motion.step_acceleration(end - dt, end, dt) for end in ends])
        wanted = np.array([exact.step_acceleration(end - dt, end, dt) for end in ends])
        errors.append(np.abs(found - wanted).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([2.0, 2.0], abs=0.1)


def test_table_never_exceeds_its_samples():
    time = np.arange(6.0)
    square = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
    motion = TableMotion(MotionTable(time=time, acceleration=np.column_stack([square] * 3)))
    values = np.array([motion.acceleration(t) for t in np.linspace(0.0, 5.0, 201)])
    assert values.min() >= -1e-15
    assert values.max() <= 1.0 + 1e-15


def test_a_table_may_have_a_header_comments_and_empty_lines(tmp_path: Path):
    file = tmp_path / "truck.csv"
    file.write_text("\ufefftime, ax, ay, az\n# lorry\n0, 0, 0, 0\n\n0.5, 1, 2, 3\n")
    table = read_motion_table(file)
    assert table.time.tolist() == [0.0, 0.5]
    assert table.acceleration[1].tolist() == [1.0, 2.0, 3.0]


def test_a_file_that_is_no_text_is_refused(tmp_path: Path):
    file = tmp_path / "table.csv"
    with pytest.raises(TableError, match=r"table\.csv: cannot be read: No such file"):
        read_motion_table(file)
    file.write_bytes(b"0,0,0,0\n\0\xff\xfe")
    with pytest.raises(TableError, match=r"is not a text file\. Export"):
        read_motion_table(file)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("0,0,0,0\n1,2,3\n", "line 2: must hold four finite numbers"),
        ("time,ax,ay,az\n0,0,0,0\n1,0,0,wobble\n", "line 3: must hold four finite numbers"),
        ("0,0,0,0\n1,0,nan,0\n", "line 2: must hold four finite numbers"),
        ("0,0,0,0\n0,1,1,1\n", "line 2: time must increase, got 0 after 0"),
        ("time,ax,ay,az\n", "holds 0 lines of numbers"),
        ("time,ax,ay,az\nm/s,x,x,x\n0,0,0,0\n1,0,0,0\n", "line 2: the unit 'm/s' of time"),
    ],
)
def test_a_wrong_table_is_refused_with_its_line(tmp_path: Path, text: str, says: str):
    file = tmp_path / "table.csv"
    file.write_text(text)
    with pytest.raises(TableError, match=says) as caught:
        read_motion_table(file)
    assert str(file) in str(caught.value)


def test_the_scene_chooses_the_motion(tmp_path: Path):
    assert not motion_of(scene_from(MINIMAL)).acceleration(0.3).any()
    file = tmp_path / "table.csv"
    file.write_text("0,1,0,0\n2,1,0,0\n")
    tabled = scene_from(MINIMAL | {"motion": {"kind": "table", "file": str(file)}})
    assert motion_of(tabled).velocity(0.5) == pytest.approx([0.5, 0, 0], rel=1e-14)
    shaken = {"kind": "sine", "frequency": 2.0, "amplitude": 0.1, "direction": [0.0, 3.0, 0.0]}
    motion = motion_of(scene_from(MINIMAL | {"motion": shaken}))
    assert motion.displacement(1.125) == pytest.approx([0.0, 0.1, 0.0], abs=1e-15)
