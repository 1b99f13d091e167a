"""p* in the band of the motion's first harmonics, whatever blows lie above it."""

from types import SimpleNamespace

import numpy as np
import pytest
from small_scene import SMALL

from coupling.metrics.harmonic import BAND
from coupling.scene.scene import load_scene
from coupling.simulation.pressure_band import PressureBand

POSITION = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])  # two equal triangles
TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
PATTERN = np.array([1.0, -2.0, 1.0, -2.0])  # no mean over the area; a mean square of 2
FREQUENCY, STEP = 2.0, 0.005


@pytest.fixture
def scene(tmp_path):
    times = "[time]\nperiods = 3.0\nsteps_per_period = 100\n"
    (tmp_path / "scene.toml").write_text(SMALL + times)
    return load_scene(tmp_path)


def gathered(band, *, blow, before=0.0, steps=range(301)):
    for step in steps:
        time = step * STEP
        wave = 30.0 * np.cos(2 * np.pi * FREQUENCY * time + 0.4)
        wave += blow * np.cos(2 * np.pi * (BAND + 1) * FREQUENCY * time)
        band.add(
            SimpleNamespace(
                time=time, position=POSITION,
                dynamic_pressure=500.0 + PATTERN * (before if time < 1.0 else wave),
                metrics={"hydrostatic_pressure_rms": 60.0},
            ),
            TRIANGLES,
        )  # fmt: skip
    return band.fraction


@pytest.mark.parametrize("blow", [0.0, 1e3])
def test_a_wave_in_the_band_counts_and_a_blow_above_it_does_not(scene, blow):
    # The last of two whole periods after the ramp is fitted; rms 30/sqrt(2) sqrt(2) over 60.
    assert gathered(PressureBand(scene), blow=blow, before=1e4) == pytest.approx(0.5, rel=1e-9)


def test_restored_it_goes_on_bit_for_bit(scene):
    whole, part, rest = (PressureBand(scene) for _ in range(3))
    gathered(part, blow=7.0, steps=range(250))
    rest.restore(part.save())
    assert gathered(rest, blow=7.0, steps=range(250, 301)) == gathered(whole, blow=7.0)


def test_a_run_shorter_than_a_period_has_none(scene):
    short = scene.model_copy(update={"time": scene.time.model_copy(update={"duration": 0.1})})
    assert gathered(PressureBand(short), blow=0.0) is None


def test_a_run_that_was_made_longer_has_none(scene):
    short = PressureBand(scene)
    gathered(short, blow=0.0)
    time = scene.time.model_copy(update={"duration": 2.0 * scene.time.duration})
    longer = PressureBand(scene.model_copy(update={"time": time}))
    longer.restore(short.save())
    assert gathered(longer, blow=0.0, steps=range(301, 601)) is None
