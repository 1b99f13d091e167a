"""Statistics of runs by a record: known signals have known rms, crossings, bands and errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coupling.metrics.record import LEVELS, crossings, record_statistics
from coupling.metrics.record_errors import answered, band_errors, reference_bands
from coupling.metrics.record_verdict import record_verdict
from coupling.metrics.spectra import octaves, spectrum_of
from coupling.ports import Array
from coupling.scene.scene import Scene, scene_from
from coupling.store.step_series import StepSeries

STEP, DURATION, MASS = 0.01, 64.0, 30.0
TIME = np.arange(0.0, DURATION + 0.5 * STEP, STEP)


def wave(frequency: float, amplitude: float, phase: float = 0.0) -> Array:
    return amplitude * np.sin(2.0 * np.pi * frequency * TIME + phase)


def along_x(signal: Array) -> Array:
    return np.column_stack([signal, 0.0 * signal, 0.0 * signal])


def steps(cg: Array, force: Array, acceleration: Array) -> StepSeries:
    nothing = np.zeros(len(TIME))
    return StepSeries(
        time=TIME, tank_acceleration=acceleration, tank_displacement=0.0 * acceleration,
        tank_rotation=0.0 * acceleration, tank_rate=0.0 * acceleration,
        volume=nothing, datum_pressure=nothing, liquid_cg=cg, force=force, moment=0.0 * force,
        iterations=nothing.astype(np.int64), residual=nothing, metrics={},
    )  # fmt: skip


def scene(folder: Path, kind: str = "table") -> Scene:
    motion = {"kind": "sine", "frequency": 1.0, "amplitude": 0.01}
    if kind == "table":
        (folder / "m.csv").write_text("0,0,0,0\n1,1,0,0\n100,0,0,0\n")
        motion = {"kind": "table", "file": str(folder / "m.csv")}
    return scene_from({
        "tank": {"radius": 0.2}, "diaphragm": {"thickness": 0.0015, "material": "AF-E-332"},
        "liquid": {"name": "water", "fill_fraction": 0.5}, "motion": motion,
        "time": {"duration": DURATION, "step": STEP},
    })  # fmt: skip


def test_bands_hold_the_power_of_the_waves_in_them() -> None:
    signal = along_x(3.0 + wave(0.75, 2.0) + wave(6.0, 0.5))
    found = spectrum_of(TIME, signal)
    assert found is not None
    assert found.line == pytest.approx(4.0 / DURATION, rel=1e-3)
    power = {band: found.power(band)[0] for band in octaves(found)}
    assert [round(low, 3) for low, _ in power][:4] == [0.0, 0.125, 0.25, 0.5]
    # Parseval of a Hann window: all of a wave, but for cos(2 w t) over 12 periods and more.
    assert power[0.5, 1.0] == pytest.approx(2.0, rel=1e-3)
    assert power[4.0, 8.0] == pytest.approx(0.125, rel=1e-3)
    assert sum(power.values()) == pytest.approx(2.125, rel=1e-3)


def test_uneven_instants_are_made_even_and_few_say_nothing() -> None:
    kept = np.ones(len(TIME), dtype=bool)
    kept[5::97] = False
    found = spectrum_of(TIME[kept], wave(0.75, 2.0)[kept][:, None])
    assert found is not None
    # A line across 2 steps of a wave misses (pi f h)^2 of it in places: 5e-4.
    assert found.power((0.5, 1.0))[0] == pytest.approx(2.0, rel=2e-3)
    assert spectrum_of(TIME[:63], along_x(TIME)[:63]) is None


def test_a_band_s_scatter_is_that_of_white_noise() -> None:
    """rms of many records' bands, against 1/(2 sqrt(B T))."""
    rng = np.random.default_rng(3)
    rms, said = [], 0.0
    noise = rng.normal(size=(len(TIME), 400))
    found = spectrum_of(TIME, noise)
    assert found is not None
    said = found.random_error((2.0, 4.0))
    rms = np.sqrt(found.power((2.0, 4.0)))
    # Of 400 records: the scatter is known to 1/sqrt(800) = 3.5 %, three of them 11; Hann windows of
    # four segments, at their ends of less weight, lose some 8 % of the record.
    assert np.std(rms) / np.mean(rms) == pytest.approx(said, rel=0.2)
    assert np.mean(rms) == pytest.approx(np.sqrt(2.0 / 50.0), rel=3.0 * said / 20.0 + 0.01)


def test_a_sine_crosses_every_level_once_a_period() -> None:
    signal = wave(0.5, 1.0, 0.1)
    counts = dict(zip(LEVELS, crossings(signal, np.sqrt(0.5)), strict=True))
    for level in (-1.0, -0.5, 0.5, 1.0):
        assert counts[level] == 32
    assert counts[0.0] in (31, 32)  # it starts above 0
    for level in (-2.0, -1.5, 1.5, 2.0):  # its peak is 1.41 rms
        assert counts[level] == 0
    assert crossings(0.0 * signal, 0.0) == [0] * len(LEVELS)


def test_gaussian_noise_crosses_levels_as_rice_has_it() -> None:
    """White in 0 to fc: N0 = fc/sqrt(3) upward crossings a second, exp(-l^2/2) of it at l rms."""
    rng = np.random.default_rng(4)
    count, top = 2**17, 5.0
    lines = np.zeros(count // 2 + 1, dtype=complex)
    inside = np.arange(1, int(top * count * STEP))
    lines[inside] = rng.normal(size=len(inside)) + 1j * rng.normal(size=len(inside))
    signal = np.fft.irfft(lines)
    counts = dict(zip(LEVELS, crossings(signal, float(signal.std())), strict=True))
    for level in (-3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0):
        rice = count * STEP * top / np.sqrt(3.0) * np.exp(-0.5 * level**2)
        assert counts[level] == pytest.approx(rice, abs=4.0 * np.sqrt(rice))  # Poisson, at most


def test_a_run_s_record_has_rms_and_peaks_about_the_mean(tmp_path: Path) -> None:
    run = steps(
        cg=along_x(0.5 + wave(0.75, 0.02)), force=along_x(wave(6.0, 10.0)),
        acceleration=along_x(wave(6.0, 2.0)),
    )  # fmt: skip
    found = record_statistics(run, scene(tmp_path))
    assert found is not None
    cg = found["signals"]["cg"]
    assert (cg["unit"], len(cg["crossings"]), len(cg["crossings"][0])) == ("m", 3, len(LEVELS))
    assert cg["rms"] == pytest.approx([0.02 / np.sqrt(2.0), 0.0, 0.0], rel=1e-3)
    assert cg["peak"] == pytest.approx([0.02, 0.0, 0.0], rel=1e-3)
    assert cg["mean"] == pytest.approx([0.5, 0.0, 0.0], abs=1e-5)
    band = next(row for row in found["bands"] if row["from_hz"] == 4.0)
    assert band["rms"]["force"][0] == pytest.approx(10.0 / np.sqrt(2.0), rel=1e-3)
    assert band["rms"]["cg"][0] < 1e-4
    # 64 lines of four over 64 s in an octave from 4 to 8 Hz.
    assert band["random_error"] == pytest.approx(0.5 / np.sqrt(4.0 * DURATION), rel=1e-2)
    assert record_statistics(run, scene(tmp_path, "sine")) is None


def test_errors_by_band_are_those_of_the_waves_in_them() -> None:
    still = along_x(0.0 * TIME)
    best = steps(along_x(wave(0.75, 0.02) + wave(6.0, 0.004)), along_x(wave(6.0, 1.0)), still)
    mine = steps(
        along_x(wave(0.75, 0.022) + wave(6.0, 0.004, np.pi / 2.0)), along_x(wave(6.0, 0.0)), still
    )
    found = band_errors(mine, best)
    cg, force = found["cg"], found["force"]
    assert cg["0.5 to 1 Hz"] == pytest.approx(0.1, rel=1e-2)
    assert cg["4 to 8 Hz"] == pytest.approx(np.sqrt(2.0), rel=1e-2)  # a quarter of a period late
    assert cg["16 to 32 Hz"] is None  # nothing is there to be wrong about
    assert force["4 to 8 Hz"] == pytest.approx(1.0, rel=1e-9)  # it does not move
    whole = np.sqrt((0.002**2 + 2.0 * 0.004**2) / (0.02**2 + 0.004**2))
    assert cg["all"] == pytest.approx(whole, rel=1e-2)


def test_the_reference_s_bands_say_what_it_answers_to() -> None:
    shaken = along_x(wave(0.75, 1.0) + wave(6.0, 2.0))
    rigid = steps(along_x(wave(0.75, 0.02) + wave(6.0, 0.002)), -MASS * shaken, shaken)
    bands = reference_bands(rigid, MASS)
    rows = {row["from_hz"]: row for row in bands}
    assert rows[4.0]["force_over_ma"] == pytest.approx(1.0, rel=1e-9)
    assert rows[16.0]["force_over_ma"] is None  # nothing shakes there
    assert rows[0.5]["cg_rms_m"] == pytest.approx(0.02 / np.sqrt(2.0), rel=1e-3)
    assert rows[4.0]["cg_share"] == pytest.approx(1.0 / 101.0, rel=1e-2)
    assert answered(bands) == ["0.5 to 1 Hz"]


@pytest.mark.parametrize(
    ("errors", "bar", "said"),
    [
        (
            {"0.5 to 1 Hz": 0.01, "1 to 2 Hz": 0.3, "all": 0.02},
            0.005,
            "lies in 0.5 to 1 Hz; hydrostatics was enough there",
        ),
        (
            {"0.5 to 1 Hz": 0.04, "1 to 2 Hz": 0.03, "all": 0.04},
            0.02,
            "hydrostatics errs there by 4\u202f% (0.5 to 1 Hz): it was not enough. It was enough "
            "in 1 to 2 Hz. Over the whole spectrum it errs by 4\u202f% ± 2\u202f% in",
        ),
        (
            {"0.5 to 1 Hz": 1.2, "1 to 2 Hz": None, "all": 1.2},
            0.0,
            "by 120\u202f% (0.5 to 1 Hz): it was not enough. It was enough in no band.",
        ),
    ],
)
def test_the_verdict_goes_by_the_bands_that_move(errors, bar, said: str) -> None:
    bands = [
        {"from_hz": 0.5, "to_hz": 1.0, "cg_share": 0.95},
        {"from_hz": 1.0, "to_hz": 2.0, "cg_share": 0.05},
    ]
    bars = {"cg": {"0.5 to 1 Hz": bar, "1 to 2 Hz": 0.01, "all": bar}}
    assert said in record_verdict("potential", bands, {"hydrostatic": {"cg": errors}}, bars)
    assert record_verdict("hydrostatic", bands, {"datum": {"cg": errors}}, bars) == ""
