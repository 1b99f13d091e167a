"""What a record does to the tank where it is faster than the time steps."""

from pathlib import Path

import numpy as np
import pytest
from test_records import G, scene, written

from coupling.simulation.driver import run
from coupling.store.results import read_results


@pytest.mark.parametrize("phase", [0.0, 0.7, np.pi / 2])
def test_what_is_faster_than_the_steps_does_not_move_the_liquid(tmp_path: Path, phase: float):
    """Samples of 100 Hz every 10 ms are a constant, of any size: the CG moved by up to 33 mm."""
    time = np.arange(0.0, 0.2, 0.001)
    wave = np.column_stack([np.sin(2 * np.pi * 100 * time + phase), 0 * time, 0 * time])
    shaken = scene(written(tmp_path / "m.csv", time, wave))
    run(shaken, tmp_path / "run")
    results = read_results(tmp_path / "run")
    assert np.abs(results.tank_acceleration).max() < 1e-6 * G  # ten samples a period sum to 0
    still = scene(written(tmp_path / "0.csv", time, 0 * wave))
    run(still, tmp_path / "still")
    calm = read_results(tmp_path / "still").liquid_cg
    # Each from its own rest: the sheet is as stiff as the record's largest acceleration asks for.
    moved = results.liquid_cg - results.liquid_cg[0] - (calm - calm[0])
    assert np.abs(moved).max() < 1e-7
    log = (tmp_path / "run" / "log.txt").read_text()
    assert "record m.csv: time [s], ax, ay, az [g] (by the header in line 1)" in log
    assert "% of the record's power is above 50 Hz, half the rate of the time steps" in log


@pytest.mark.parametrize("start", [0.0, 0.033])
def test_a_shock_shorter_than_the_steps_gives_its_momentum(tmp_path: Path, start: float):
    """30 g for 11 ms at steps of 10 ms, which a sample may miss: 2/pi of them is the velocity."""
    time = np.arange(0.0, 0.2, 0.0005)
    inside = (time - start) / 0.011
    pulse = np.where((inside > 0) & (inside < 1), 30 * np.sin(np.pi * inside), 0.0)
    shaken = scene(written(tmp_path / "m.csv", time, np.column_stack([pulse, 0 * time, 0 * time])))
    run(shaken, tmp_path / "run")
    change = 0.01 * read_results(tmp_path / "run").tank_acceleration[:, 0].sum()
    # The interpolant's own integral is (pi/22)^2/12 = 0.2 % short of the sine's.
    assert change == pytest.approx(30 * G * 0.011 * 2 / np.pi, rel=2e-3)
    assert change == pytest.approx(np.trapezoid(pulse * G, time), rel=1e-8)
    moved = read_results(tmp_path / "run").tank_displacement[-1, 0]
    # Its centre is at the middle of the pulse.
    assert moved == pytest.approx(change * (0.09 - start - 0.0055), rel=1e-6)
