"""A record made from densities has them, whatever the seed; what it could not hold is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import welch
from scipy.stats import chi2
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.motion.psd import record_of
from coupling.motion.shaking import motion_of
from coupling.scene.scene import SceneError, scene_from
from coupling.scene.spectrum_table import SpectrumTable, read_spectrum_table
from coupling.scene.tables.text import TableError

G = 9.80665
NAMES = "Frequency (Hz),x (g^2/Hz),y (g^2/Hz),z (g^2/Hz)\n"
LORRY = NAMES + "1,1e-4,0,7e-4\n3,4e-3,0,0.018\n4,4e-3,0,0.018\n20,1e-4,0,7e-4\n"


def table(tmp_path: Path, text: str = LORRY) -> SpectrumTable:
    file = tmp_path / "s.csv"
    file.write_text(text)
    return read_spectrum_table(file)


def data(file: Path, **changes):
    sections = {
        "tank": {"radius": 0.2032},
        "diaphragm": {"thickness": 0.001524, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.5},
        "motion": {"kind": "psd", "file": str(file), "duration": 10.0, "seed": 1},
        "model": {"fluid": "hydrostatic"},
        "cloth": {"resolution": 6},
        "time": {"duration": 10.0, "step": 0.005},
    }
    for section, values in changes.items():
        sections[section] = sections[section] | values
    return sections


def test_the_power_of_a_table_is_the_integral_of_straight_lines_in_logarithms(tmp_path: Path):
    lines = NAMES + "1,1,2,0\n10,1,0.2,4\n20,0.25,0.2,0\n"
    found = table(tmp_path, lines)
    # Even: 9; of -2: 10^2 (1/10 - 1/20). 2/f: 2 log 10, then even. Straight from and to 0: 18 + 20.
    exact = G**2 * np.array([9.0 + 5.0, 2.0 * np.log(10.0) + 0.2 * 10.0, 18.0 + 20.0])
    np.testing.assert_allclose(found.rms**2, exact, rtol=1e-13)
    # The part up to 5 Hz; nothing before the first line, nothing after the last.
    below = found.power_below(np.array([0.5, 5.0, 99.0]))
    np.testing.assert_allclose(below[1], G**2 * np.array([4.0, 2.0 * np.log(5.0), 4 / 18 * 16]))
    np.testing.assert_allclose(below[[0, 2]], [[0.0] * 3, exact], rtol=1e-13)
    assert found.band == (1.0, 20.0)


def test_the_record_has_the_power_of_the_table_whatever_the_seed(tmp_path: Path):
    given = table(tmp_path)
    for seed in (1, 2):
        record = record_of(given, seed, 60.0)
        # Samples carry a harmonic whole, enlarged by at most (1 + (pi/20)^2/3)^2 of its power.
        rms = np.sqrt(np.mean(record.acceleration[:-1] ** 2, axis=0))
        assert np.all(rms >= given.rms * (1.0 - 1e-12))
        assert np.all(rms <= given.rms * (1.0 + 0.0083))
        assert rms[1] == 0.0
    assert not np.allclose(record.acceleration, record_of(given, 1, 60.0).acceleration)


def test_the_line_between_samples_carries_each_harmonic_whole(tmp_path: Path):
    """The Fourier integral of the straight lines, by their own quadrature."""
    one = NAMES + "4,0.01,0,0\n4.5,0.01,0,0\n"
    record = record_of(table(tmp_path, one), 3, 2.0)  # harmonics 8 and 9
    fine = np.linspace(0.0, 2.0, 200_001)[:-1]
    lines = np.fft.rfft(np.interp(fine, record.time, record.acceleration[:, 0])) / len(fine)
    # 0.25 Hz of the table lie within 0.25 Hz of either.
    np.testing.assert_allclose(2.0 * np.abs(lines[[8, 9]]) ** 2, 0.25 * 0.01 * G**2, rtol=1e-6)


def test_welch_finds_the_spectrum_of_the_table_within_its_own_error(tmp_path: Path):
    """Hann windows, half overlapping: 0.95 of the 2 N degrees of freedom of as many apart.

    Welch (IEEE Trans. AU-15, 1967): N segments that overlap by half have the scatter of 9/11 N.
    """
    given = table(tmp_path)
    record = record_of(given, 5, 600.0)
    rate = (len(record.time) - 1) / 600.0
    length = 10.0  # s of a segment: lines of 0.1 Hz
    size = round(length * rate)
    frequency, found = welch(record.acceleration[:-1, 2], rate, nperseg=size)
    inside = (frequency > 1.5) & (frequency < 19.0)
    edges = np.stack([frequency - 0.5 / length, frequency + 0.5 / length])[:, inside]
    wanted = np.diff([given.power_below(part)[:, 2] for part in edges], axis=0)[0] * length
    ratio = found[inside] / wanted
    freedom = 2.0 * 9.0 / 11.0 * (2.0 * 600.0 / length - 1.0)
    # One in a thousand of all lines together may lie outside.
    low, high = chi2.ppf([5e-4 / len(ratio), 1.0 - 5e-4 / len(ratio)], freedom) / freedom
    assert low < ratio.min()
    assert ratio.max() < high
    # Neighbours within a window's width are alike: a third of the lines are apart.
    assert abs(ratio.mean() - 1.0) < 4.0 * np.sqrt(2.0 / freedom / (len(ratio) / 3.0))


def test_steps_follow_the_record_and_repeat_with_the_seed(tmp_path: Path):
    (tmp_path / "s.csv").write_text(LORRY)
    scene = scene_from(data(tmp_path / "s.csv"))
    motion, again = motion_of(scene), motion_of(scene_from(data(tmp_path / "s.csv")))
    ends = np.arange(1, 2001) * 0.005
    driven = np.array([motion.working_acceleration(end - 0.005, end) for end in ends])
    same = np.array([again.working_acceleration(end - 0.005, end) for end in ends])
    np.testing.assert_array_equal(driven, same)
    # The mean over a step holds sinc(f h)^2 of a harmonic's power, 0.97 at 20 Hz and 5 ms.
    rms = np.sqrt(np.mean(driven**2, axis=0))
    exact = scene.motion.spectrum.rms
    assert np.all(rms <= exact * (1.0 + 1e-9))
    assert rms[2] > 0.985 * exact[2]
    # It does not drift: where it was after a period, and with the velocity of one that goes on.
    assert np.abs(motion.displacement(10.0)).max() < 1e-9
    before, after = motion.velocity(0.0), motion.velocity(10.0)
    np.testing.assert_allclose(before, after, atol=1e-9)
    moved = [motion.displacement(time)[2] for time in np.arange(0.0, 10.0, 0.05)]
    assert max(moved) - min(moved) < 0.2  # 1 to 20 Hz with 0.3 g rms: centimetres


REFUSED = {
    "above the steps": (
        {"time": {"step": 0.04}},
        "has energy up to 20 Hz, and steps of time.step = 0.04 s carry 12.5 Hz. Give "
        "time.step = 0.025 or less, or end the table at 12.5 Hz",
    ),
    "below the record": (
        {"motion": {"duration": 0.5}, "time": {"duration": 0.5}},
        "has energy from 1 Hz on, and a record of motion.duration = 0.5 s holds nothing below "
        "2 Hz. Give motion.duration = 1 or more",
    ),
    "shorter than the run": (
        {"time": {"duration": 12.0}},
        "motion.duration: must cover 0 to 12 s, got 10. Give 12 or more",
    ),
    "too many harmonics": ({"motion": {"duration": 1e5}}, "makes 2e+06 harmonics"),
    "no seed": ({"motion": {"seed": None}}, 'motion.seed: is required for kind = "psd". Give the'),
    "no duration": ({"motion": {"duration": None}}, "motion.duration: is required"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_the_record_could_not_hold_is_refused(tmp_path: Path, name: str):
    (tmp_path / "s.csv").write_text(LORRY)
    changes, says = REFUSED[name]
    with pytest.raises(SceneError) as caught:
        scene_from(data(tmp_path / "s.csv", **changes))
    (line,) = caught.value.problems
    assert says in line


def test_the_mends_are_taken(tmp_path: Path):
    (tmp_path / "s.csv").write_text(LORRY)
    scene_from(data(tmp_path / "s.csv", time={"step": 0.025}))
    scene_from(data(tmp_path / "s.csv", motion={"duration": 1.0}, time={"duration": 1.0}))


def test_a_seed_beside_a_sine_is_not_passed_over(tmp_path: Path):
    sine = {"kind": "sine", "frequency": 1.0, "amplitude": 0.01, "file": None, "duration": None}
    with pytest.raises(SceneError, match=r'motion.seed: is read with motion.kind = "psd" only'):
        scene_from(data(tmp_path / "s.csv", motion=sine))


WRONG = {
    "negative": (NAMES + "1,1,1,-1\n2,1,1,1\n", "line 2: a density must not be negative, got -1"),
    "zero Hz": (NAMES + "0,1,1,1\n2,1,1,1\n", "line 2: frequencies must be positive and increase"),
    "twice": (NAMES + "1,1,1,1\n2,1,1,1\n2,3,1,1\n", "line 4: frequencies must be positive and in"),
    "no z": ("Hz,x,y\n1,1,1\n2,1,1\n", "line 1: names no column frequency, z"),
    "decibels": ("f (Hz),x (dB),y (dB),z (dB)\n1,1,1,1\n2,1,1,1\n", "the unit 'dB' of x is not"),
    "a gap": (NAMES + "1,1,1,1\n2,1,nan,1\n", "line 3: must hold four finite numbers frequency, x"),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_table_is_refused_with_its_line(tmp_path: Path, name: str):
    text, says = WRONG[name]
    with pytest.raises(TableError, match=says):
        table(tmp_path, text)


@pytest.mark.parametrize(
    ("text", "scale"),
    [
        ("Freq;X;Y;Z\n1,5;0,01;0;0\n2,5;0,01;0;0\n", G**2),
        ("Freq [Hz]\tx [m²/s³]\ty [m²/s³]\tz [m²/s³]\n1.5\t0.01\t0\t0\n2.5\t0.01\t0\t0\n", 1.0),
    ],
)
def test_tables_are_read_in_the_units_of_their_header(tmp_path: Path, text: str, scale: float):
    assert table(tmp_path, text).rms[0] ** 2 == pytest.approx(0.01 * scale, rel=1e-12)


def test_check_prints_the_rms_and_the_band(tmp_path: Path):
    (tmp_path / "s.csv").write_text(LORRY)
    (tmp_path / "scene.toml").write_text(
        'tank.radius = 0.2032\ndiaphragm.thickness = 0.001524\ndiaphragm.material = "AF-E-332"\n'
        'liquid.name = "water"\nliquid.fill_fraction = 0.5\nmodel.fluid = "hydrostatic"\n'
        'motion.kind = "psd"\nmotion.file = "s.csv"\nmotion.duration = 10\nmotion.seed = 1\n'
        "time.duration = 10\n"
    )
    answer = CliRunner().invoke(app, ["check", str(tmp_path), "--json"])
    assert answer.exit_code == 0, answer.output
    record = json.loads(answer.output)["record"]
    spectrum = read_spectrum_table(tmp_path / "s.csv")
    # Samples are enlarged by 0.8 % at the most (record_of).
    assert record["rms_m_s2"] == pytest.approx(spectrum.rms.tolist(), rel=0.0083)
    low, high = record["band_hz"]
    assert 1.0 < low < 3.0 < 4.0 < high < 20.0
    assert record["warnings"] == []
    text = " ".join(CliRunner().invoke(app, ["check", str(tmp_path)]).output.split())
    assert "record s.csv: made of 4 lines of x, y, z [g^2/Hz] (by the header in line 1)" in text
    assert "1 to 20 Hz, (0.133, 0, 0.297) g rms" in text
    assert "rms (1.3, 0, 2.92) m/s^2, nine tenths of its power between" in text
