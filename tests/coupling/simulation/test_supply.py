"""The liquid's volume follows its supply."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest
from small_scene import SMALL

from coupling.fluids.supply import ClosedTank, supply_of
from coupling.scene.scene import load_scene
from coupling.simulation.participants import Participants


@dataclass(frozen=True)
class Drawn:
    """A tank of ``amount`` [m^3] that loses ``rate`` [m^3/s]."""

    amount: float
    rate: float

    def volume(self, time: float) -> float:
        return self.amount - self.rate * time


def test_the_volume_below_the_sheet_is_what_the_supply_leaves(tmp_path: Path):
    """To the step's own closure of the volume, 1e-13 of it."""
    (tmp_path / "scene.toml").write_text(SMALL + "[time]\nduration = 0.1\n")
    scene = load_scene(
        tmp_path, ["model.fluid=hydrostatic", "cloth.resolution=6", "time.step=0.02"]
    )
    assert supply_of(scene) == ClosedTank(scene.liquid_volume)
    both = Participants(scene, tmp_path)
    both.supply = Drawn(scene.liquid_volume, 0.5 * scene.liquid_volume)
    both.settle()
    both.start(lambda *_: None)
    for step in range(3):
        both.advance(0.02 * step, 0.02 * (step + 1))
        wanted = both.supply.volume(0.02 * (step + 1))
        assert both.cloth.state.volume == pytest.approx(wanted, rel=1e-12)
    assert both.tally.statistics.volume_error_max < 1e-12
    assert wanted == pytest.approx(0.97 * scene.liquid_volume)
