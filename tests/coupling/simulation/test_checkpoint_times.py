"""When checkpoints are taken, and that taking them changes nothing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from small_scene import SMALL

from coupling.scene.scene import load_scene
from coupling.simulation import driver
from coupling.store.results import read_results
from coupling.store.results_layout import FIELDS

STEPS = 12
SCENE = f"""\
{SMALL}[model]
fluid = "potential"
[cloth]
resolution = 6
[time]
duration = 0.12
step = 0.01
output_every = 5
"""


def saved_at(
    folder: Path, monkeypatch: pytest.MonkeyPatch, share: float, *changes: str
) -> list[int]:
    """Steps after which a run into ``folder`` took a checkpoint."""
    steps: list[int] = []
    save = driver.save_run

    def noted(*arguments: object, step: int, **rest: object) -> None:
        steps.append(step)
        save(*arguments, step=step, **rest)  # type: ignore[arg-type]

    folder.mkdir()
    (folder / "scene.toml").write_text(SCENE)
    with monkeypatch.context() as patch:
        patch.setattr(driver, "save_run", noted)
        patch.setattr(driver, "_CHECKPOINT_SHARE", share)
        driver.run(load_scene(folder, changes), folder / "run")
    return steps


def test_checkpoints_go_by_wall_time_and_at_most_so_many_steps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A share of a billionth allows none but the first and the last, one of a billion any."""
    rare = saved_at(tmp_path / "rare", monkeypatch, 1e-9)
    bound = saved_at(tmp_path / "bound", monkeypatch, 1e-9, "time.checkpoint_every=5")
    often = saved_at(tmp_path / "often", monkeypatch, 1e9)
    assert rare == [0, STEPS]
    assert bound == [0, 5, 10, STEPS]
    assert often == list(range(STEPS + 1))
    one, other = (read_results(tmp_path / name / "run") for name in ("rare", "often"))
    for name, _ in FIELDS.values():
        assert np.array_equal(getattr(one, name), getattr(other, name)), name
