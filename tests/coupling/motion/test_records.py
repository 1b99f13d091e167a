"""Records as loggers write them: each is read rightly and said, or refused with line and mend."""

import json
import pickle
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.motion.record_summary import record_summary
from coupling.scene.motion_file import read_motion_table
from coupling.scene.scene import SceneError, scene_from
from coupling.scene.tables import file as table_file
from coupling.scene.tables.text import TableError

G = 9.80665
TIME = np.arange(20) * 0.005
VALUES = np.round(
    np.column_stack([np.sin(20 * TIME), np.full(20, 0.25), np.cos(9 * TIME)]), decimals=6
)
NAMES = "time,ax,ay,az\n"


def seconds(t: float) -> str:
    return f"{t:.6f}"


def iso(t: float) -> str:
    return (datetime(2024, 3, 1, 10) + timedelta(seconds=float(t))).isoformat(
        timespec="milliseconds"
    )


def lines(separator=",", mark=".", clock=seconds, end="", scale=1.0, quote="") -> str:
    rows = [
        [clock(t), *(f"{value * scale:.9f}" for value in row)]
        for t, row in zip(TIME, VALUES, strict=True)
    ]
    cells = [[f"{quote}{cell.replace('.', mark)}{quote}" for cell in row] for row in rows]
    return "".join(separator.join(row) + end + "\n" for row in cells)


def numbered(text: str) -> str:
    return "".join(f"{k},{line}\n" for k, line in enumerate(text.splitlines()))


def columns(order: str) -> str:
    table = {"t": TIME, "x": VALUES[:, 0], "y": VALUES[:, 1], "z": VALUES[:, 2]}
    stacked = np.column_stack([table[name] for name in order])
    return "".join(",".join(f"{value:.9f}" for value in row) + "\n" for row in stacked)


IN_G = {"scale": 1 / G}
ASSUMED = "missing units assumed"
READ = {
    "plain": (NAMES + lines(), ASSUMED),
    "no header": (lines(), "columns and units assumed: the file has no header"),
    "semicolons, decimal comma": ("Zeit;X;Y;Z\n" + lines(";", ","), ASSUMED),
    "semicolons, no header": (lines(";", ","), "no header"),
    "tabs": (NAMES.replace(",", "\t") + lines("\t"), ASSUMED),
    "tabs, decimal comma": (NAMES.replace(",", "\t") + lines("\t", ","), ASSUMED),
    "blanks": ("# time, ax, ay, az\n" + lines("   "), ASSUMED),
    "blanks and units": ("Time (s)  X (g)  Y (g)  Z (g)\n" + lines(" ", ",", **IN_G), "az [g]"),
    "blanks around commas": ("time , ax , ay , az\n" + lines(" , "), ASSUMED),
    "quotes": ('"time","ax","ay","az"\n' + lines(quote='"'), ASSUMED),
    "quotes, decimal comma": ('"time","ax","ay","az"\n' + lines(mark=",", quote='"'), ASSUMED),
    "trailing comma": ("time,ax,ay,az,\n" + lines(end=","), ASSUMED),
    "trailing comma below": (NAMES + lines(end=","), ASSUMED),
    "trailing comma, no header": (lines(end=","), "no header"),
    "row of units": (NAMES + "s,g,g,g\n" + lines(**IN_G), "az [g] (by the header in line 1)"),
    "row of units in brackets": (NAMES + "[s],[m/s²],[m/s²],[m/s²]\n" + lines(), "[m/s²]"),
    "preamble": ("Logger 3\nNo;17\n\nt (s),x (g),y (g),z (g)\n" + lines(**IN_G), "in line 4"),
    "range in the preamble": (
        "Range: 16 g\ntime (s),ax (m/s^2),ay (m/s^2),az (m/s^2)\n" + lines(),
        "ax, ay, az [m/s^2] (by the header in line 2)",
    ),
    "further columns": ("time,ax,ay,az,temp,state\n" + lines(end=",21.5,ok"), "not used: temp, st"),
    "columns in another order": ("az,time,ay,ax\n" + columns("ztyx"), ASSUMED),
    "magnetometer beside": ("mag_x,t,ax,ay,az\n" + numbered(lines()), "not used: mag_x"),
    "displacement beside": ("x [mm],t [s],x [g],y [g],z [g]\n" + numbered(lines(**IN_G)), "[g]"),
    "ISO dates": (NAMES + lines(clock=iso), "time from 2024-03-01T10:00:00.000 on"),
    "ISO dates, no header": (lines(clock=iso), "time from 2024-03-01T10:00:00.000 on"),
    "hours": ("time;ax;ay;az\n" + lines(";", ",", lambda t: iso(t)[11:]), "time from 10:00:00"),
    "date and hours": (
        "date time ax ay az\n" + lines(" ", clock=lambda t: iso(t).replace("T", " ")),
        "not used: date",
    ),
    "seconds since 1970": (NAMES + lines(clock=lambda t: f"{1.7e9 + t:.3f}"), "s since 1970"),
    "milliseconds since 1970": (
        NAMES + lines(clock=lambda t: f"{1_700_000_000_000 + round(1e3 * t)}"),
        "1700000000000 ms since 1970",
    ),
    "nanoseconds since 1970": (
        "time,seconds_elapsed,ax,ay,az\n"
        + lines(clock=lambda t: f"{1_700_000_000_000_000_000 + round(1e9 * t)},{t:.6f}"),
        "ns since 1970",
    ),
    "milliseconds": ("t (ms),ax,ay,az\n" + lines(clock=lambda t: f"{1e3 * t:.1f}"), "time [ms]"),
    "g behind a slash": ("Time / s,ax / g,ay / g,az / g\n" + lines(**IN_G), "[g]"),
    "g behind a line": ("time_s,acc_x_g,acc_y_g,acc_z_g\n" + lines(**IN_G), "[g]"),
    "thousandths of g": ("t [s],acc x [mg],acc y [mg],acc z [mg]\n" + lines(scale=1e3 / G), "[mg]"),
    "a telephone's": (
        '"Time (s)","Linear Acceleration x (m/s^2)","Linear Acceleration y (m/s^2)",'
        '"Linear Acceleration z (m/s^2)","Absolute acceleration (m/s^2)"\n' + lines(end=",1.5"),
        "not used: Absolute acceleration (m/s^2)",
    ),
    "a spreadsheet's": ("sep=;\ntime;ax;ay;az\n" + lines(";", ","), "in line 2"),
    "carriage returns": ((NAMES + lines()).replace("\n", "\r\n"), ASSUMED),
    "comments between": (NAMES + lines().replace("\n0.05", "\n# gust\n\n0.05"), ASSUMED),
}


@pytest.mark.parametrize("name", READ)
def test_what_loggers_write_is_read_and_said(tmp_path: Path, name: str):
    text, says = READ[name]
    file = tmp_path / "m.csv"
    file.write_bytes(text.encode())
    table = read_motion_table(file)
    # Written with 9 digits, in g or not; seconds since 1970 are known to 2.4e-7 s.
    np.testing.assert_allclose(table.acceleration, VALUES, atol=1e-7 if "mg" not in says else 1e-6)
    np.testing.assert_allclose(table.time, TIME, atol=2.4e-7)
    assert says in table.read


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_encodings(tmp_path: Path, encoding: str):
    file = tmp_path / "m.csv"
    header = "Zeit (µs);X [m/s²];Y [m/s²];Z [m/s²]\n"
    file.write_bytes((header + lines(";", ",", lambda t: f"{1e6 * t:.0f}")).encode(encoding))
    table = read_motion_table(file)
    np.testing.assert_allclose(table.acceleration, VALUES, atol=1e-9)
    np.testing.assert_allclose(table.time, TIME, atol=1e-12)


def test_numbers_are_read_to_the_last_bit(tmp_path: Path):
    values = np.random.default_rng(4).uniform(-1, 1, (200, 4)) * 10.0 ** np.arange(-4, 12, 4)
    values[:, 0] = np.sort(values[:, 0])
    text = "".join(",".join(map(repr, row)) + "\n" for row in values.tolist())
    (tmp_path / "m.csv").write_text(text)
    np.testing.assert_array_equal(read_motion_table(tmp_path / "m.csv").acceleration, values[:, 1:])


REFUSED = {
    "not a number": (NAMES + "0,0,0,0\n1,0,nan,0\n", "line 3: must hold four finite.*remove it"),
    "empty cells": (NAMES + lines() + "0.2,,,\n", "line 22: must hold four finite"),
    "infinite": (NAMES + lines() + "0.2,inf,0,0\n", "line 22: must hold four finite"),
    "footer": (
        NAMES + lines() + "End of file\n",
        "line 22: holds 1 columns.*'End of file'.*remove",
    ),
    "cell left out": (
        "time,ax,ay,az,temp\n" + lines(end=",9") + "0.2,1,2,9\n",
        "line 22: holds 4 columns, line 1 names 5",
    ),
    "short line": (NAMES + lines() + "0.2,1,2\n", "line 22: holds 3 columns, line 1 names 4"),
    "long line": (NAMES + lines() + "0.2,1,2,3,4\n", "line 22: holds 5 columns, line 1 names 4"),
    "repeated time": (NAMES + lines() + lines(), "line 22: time must increase.*remove repeated"),
    "coarse time": (NAMES + lines(clock=lambda t: f"{t:.2f}"), r"line 4: .*\(and 8 more lines\)"),
    "two units": (
        "time (s),ax (g),ay (g),az (g)\ns,m/s^2,m/s^2,m/s^2\n" + lines(),
        "line 2: gives ax in 'm/s.2', line 1 in 'g'. Correct",
    ),
    "unknown unit": ("time (s),ax (mV),ay (mV),az (mV)\n" + lines(), "line 1: the unit 'mV' of ax"),
    "unknown unit in a row": (NAMES + "s,V,V,V\n" + lines(), "line 2: the unit 'V' of ax"),
    "unit of one axis": ("time,ax (g),ay,az\n" + lines(), "line 1: gives ax in 'g' and no unit of"),
    "unit in the preamble": ("Units: g\n" + NAMES + lines(), "line 1: mentions 'g'.*Name columns"),
    "unit in a comment": ("# in g\n" + lines(), "line 1: mentions 'g'"),
    "text without names": ("Logger 3000\n" + lines(), "line 1: is no line of numbers and names no"),
    "other names": ("time,ch1,ch2,ch3\n" + lines(), "line 1: names no column ax, ay, az"),
    "no time": ("ax,ay,az\n" + "1,2,3\n" * 9, "line 1: names no column time"),
    "axis missing": ("time,ax,az\n" + "1,2,3\n" * 9, "line 1: names no column ay"),
    "axis twice": ("time,x,ax,ay,az\n" + lines(end=",1"), "line 1: 'x' and 'ax' may each be ax"),
    "names of rows": (NAMES + numbered(lines()), "line 2: holds 5 columns, line 1 names 4"),
    "five, no header": (lines(end=",1"), "line 1: must hold four.*Name the columns in a line"),
    "commas for both": (lines(",", ","), "line 1: must hold four.*write decimals with a point"),
    "commas for both, header": (NAMES + lines(",", ","), "line 2: holds 8 columns, line 1 names 4"),
    "two decimal marks": ("t;x;y;z\n" + lines(";", ",") + "0.2;1;2;3\n", "line 22: must hold four"),
    "thousands": ("t;x;y;z\n" + lines(";", ",") + "0,2;1.000,5;2;3\n", "line 22: must hold four"),
    "dates of one country": (
        NAMES + lines(clock=lambda t: f"03/01/2024 10:00:{t:06.3f}"),
        "line 2: must hold.*Give time in seconds, or as ISO 8601",
    ),
    "milliseconds unsaid": (
        NAMES + lines(clock=lambda t: f"{1e3 * t:.0f}"),
        r"line 3: time steps by 5, and the file gives no unit.*time \(ms\)",
    ),
    "milliseconds called seconds": (
        "t (s),x,y,z\n" + lines(clock=lambda t: f"{1_700_000_000_000 + round(1e3 * t)}"),
        r"line 2: time is 1700000000000 s, which is no date",
    ),
    "two lines below the names": (NAMES + "s,g,g,g\nu,raw,raw,raw\n" + lines(), "line 3: stands"),
    "quote left open": (NAMES + lines() + '0.2,"1,2,3\n', "line 22: a quote is not closed"),
    "one line": ("1," * 10_000, "line 1: holds 20000 characters.*one sample a line"),
    "binary": ("PK\0\1\n", r"is not a text file\. Export it as CSV"),
    "empty": ("", "holds 0 lines of numbers, at least 2 are needed"),
    "names alone": (NAMES, "holds 0 lines of numbers"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_contradicts_is_refused_with_line_and_mend(tmp_path: Path, name: str):
    text, says = REFUSED[name]
    file = tmp_path / "m.csv"
    file.write_text(text)
    with pytest.raises(TableError, match=says) as caught:
        read_motion_table(file)
    assert str(caught.value).startswith(str(file))


@settings(max_examples=300, deadline=None)
@given(
    st.sampled_from(sorted(READ)),
    st.lists(
        st.tuples(
            st.integers(0, 500),
            st.integers(0, 3),
            st.text(alphabet=" \t\n,;.\"'#-+eEgx0123456789()[]/é\0", max_size=3),
        ),
        min_size=1,
        max_size=4,
    ),
)
def test_a_damaged_file_is_read_or_refused(tmp_path_factory, name: str, damages):
    text = READ[name][0]
    for place, removed, inserted in damages:
        text = text[:place] + inserted + text[place + removed :]
    file = tmp_path_factory.mktemp("damaged") / "m.csv"
    file.write_text(text)
    try:
        table = read_motion_table(file)
    except TableError as error:
        refused = str(error)
    else:
        refused = f"{file}: "
        assert np.isfinite(table.acceleration).all()
        assert (np.diff(table.time) > 0.0).all()
    assert refused.startswith(f"{file}: ")


def scene(file: Path, **changes):
    data = {
        "tank": {"radius": 0.4445},
        "diaphragm": {"thickness": 0.001778, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.8},
        "motion": {"kind": "table", "file": str(file)},
        "model": {"fluid": "hydrostatic"},
        "cloth": {"resolution": 6},
        "time": {"duration": 0.09, "step": 0.01, "settle": 0.3, "output_every": 1},
    }
    for section, values in changes.items():
        data[section] = data[section] | values
    return scene_from(data)


def written(
    path: Path, time: np.ndarray, values: np.ndarray, names="time (s),ax (g),ay (g),az (g)"
):
    rows = np.column_stack([time, values])
    path.write_text(f"{names}\n" + "".join(",".join(f"{v:.9g}" for v in r) + "\n" for r in rows))
    return path


def warnings(path: Path, time: np.ndarray, values: np.ndarray, **options) -> str:
    summary = record_summary(scene(written(path, time, values, **options)))
    assert summary is not None
    return "\n".join(summary.warnings)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_gravity_in_the_record_is_said_and_never_guessed(tmp_path: Path, sign: float):
    time = np.arange(0.0, 0.2, 0.005)
    values = np.column_stack([np.sin(30 * time), 0 * time, sign + 0.2 * np.cos(30 * time)])
    file = written(tmp_path / "m.csv", time, values)
    with pytest.raises(
        SceneError, match="near 1 g, and nothing says whether it contains"
    ) as caught:
        scene(file)
    mend = f"Give motion.at_rest = [0.0, 0.0, {sign * G}], what it shows of a tank at rest, or"
    assert mend in caught.value.problems[0]
    held = scene(file, motion={"at_rest": [0.0, 0.0, sign * G]})
    moved = values - [0.0, 0.0, sign]
    np.testing.assert_allclose(held.motion.record.acceleration, G * moved, atol=1e-7)
    found = record_summary(held)
    assert found is not None
    assert f"less (0, 0, {sign * 9.80665:g}) m/s^2" in found.says
    assert not found.warnings
    really = scene(file, motion={"at_rest": [0.0, 0.0, 0.0]})
    np.testing.assert_array_equal(
        really.motion.record.acceleration, read_motion_table(file).acceleration
    )
    turned = record_summary(scene(file, motion={"at_rest": [0.0, 0.0, 1e-3]}))
    assert turned is not None
    assert "still has a median" in turned.warnings[0]
    bare = warnings(tmp_path / "m.csv", time, values, names="time,ax,ay,az")
    assert "it seems to be in g and to contain gravity" in bare
    values[:, 2] -= sign
    assert not warnings(tmp_path / "m.csv", time, values)


def test_gaps_are_refused_and_uneven_steps_warned_of(tmp_path: Path):
    time = np.arange(0.0, 0.2, 0.005)
    kept = np.abs(time - 0.1) > 0.021
    values = np.column_stack([np.sin(30 * time)] * 3)
    written(tmp_path / "m.csv", time[kept], values[kept])
    says = r"line 18: 0.05 s are missing since line 17, where samples are 0.005 s apart\. Fill"
    with pytest.raises(TableError, match=says):
        read_motion_table(tmp_path / "m.csv")
    uneven = time + 0.001 * np.sin(1.0 + np.arange(len(time)) ** 2)
    uneven[0] = 0.0
    one = np.arange(len(time)) != 20
    assert (
        "single samples of the record are missing, 1 in all, the first behind t = 0.095"
        in warnings(tmp_path / "m.csv", time[one], values[one])
    )
    coasting = np.append(time, 9.0), np.append(values, values[-1:], axis=0)
    assert not warnings(tmp_path / "m.csv", *coasting)
    assert "steps are uneven" in warnings(tmp_path / "m.csv", uneven, values)


@pytest.mark.parametrize(("frequency", "share"), [(5.0, 0.0), (100.0, 1.0)])
def test_power_that_the_step_does_not_carry_is_said(tmp_path: Path, frequency, share):
    time = np.arange(0.0, 1.001, 0.001)
    wave = np.column_stack([np.sin(2 * np.pi * frequency * time), 0 * time, 0 * time])
    summary = record_summary(scene(written(tmp_path / "m.csv", time, wave)))
    assert summary is not None
    assert summary.power_above_step == pytest.approx(share, abs=0.01)  # leakage of a whole second
    assert ("is averaged out. Take time.step =" in "".join(summary.warnings)) == (share > 0.5)
    assert "at 1000 Hz, 0 to 1 s" in summary.says
    peak = G * np.abs(wave).max()
    assert f"peak ({peak:.3g}, 0, 0) m/s^2" in summary.says


def test_a_scene_goes_to_another_process_without_its_record(tmp_path: Path):
    time = np.arange(0.0, 1.0, 0.001)
    shaken = scene(written(tmp_path / "m.csv", time, np.column_stack([0 * time] * 3)))
    assert shaken.motion.record is shaken.motion.record
    sent = pickle.dumps(shaken)
    assert len(sent) < 4000  # the record alone is 32,000 bytes
    assert pickle.loads(sent) == shaken
    assert len(pickle.loads(sent).motion.record.time) == 1000


def test_check_says_what_it_read_and_reads_it_once(tmp_path: Path, monkeypatch):
    case = tmp_path / "case"
    case.mkdir()
    (case / "m.csv").write_text("Time (s),X (g),Y (g),Z (g)\n" + lines(**IN_G))
    (case / "scene.toml").write_text(
        'tank.radius = 0.4445\ndiaphragm.thickness = 0.001778\ndiaphragm.material = "AF-E-332"\n'
        'liquid.name = "water"\nliquid.fill_fraction = 0.8\nmodel.fluid = "hydrostatic"\n'
        'motion.kind = "table"\nmotion.file = "m.csv"\ntime.duration = 0.09\n'
    )
    read = []
    lines_of = table_file.lines_of
    monkeypatch.setattr(
        table_file, "lines_of", lambda path, data: read.append(path) or lines_of(path, data)
    )
    answer = CliRunner().invoke(app, ["check", str(case)])
    assert answer.exit_code == 0, answer.output
    assert len(read) == 1
    assert "record m.csv: time [s], ax, ay, az [g] (by the header in line 1); 20" in answer.output
    answer = CliRunner().invoke(app, ["check", str(case), "--json"])
    assert len(read) == 1  # its content is the same
    assert "20 samples at 200 Hz" in json.loads(answer.output)["record"]["says"]
    (case / "m.csv").write_text("Time (s),X (furlong),Y (g),Z (g)\n" + lines())
    answer = CliRunner().invoke(app, ["check", str(case)])
    assert answer.exit_code == 2
    assert "m.csv: line 1: the unit 'furlong' of ax is not known" in answer.output
