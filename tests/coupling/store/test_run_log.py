"""Runs in several threads of one process, as a Dask worker may have them."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import h5py
import numpy as np
from small_scene import SMALL

from coupling.scene.scene import load_scene
from coupling.simulation.driver import run

SCENE = f"""\
{SMALL}ramp = 0.0
[model]
fluid = "hydrostatic"
[cloth]
resolution = 4
tolerance = 0.001
[time]
settle = 0.3
duration = 0.3
step = 0.01
output_every = 1
"""


def test_runs_in_threads_have_their_own_logs_and_the_same_results(tmp_path: Path) -> None:
    """Each log held the lines of all runs that went at the time."""
    (tmp_path / "scene.toml").write_text(SCENE)
    scenes = [load_scene(tmp_path, [f"liquid.fill_fraction={fill}"]) for fill in (0.6, 0.8)]
    alone = [tmp_path / f"alone_{index}" for index in range(2)]
    beside = [tmp_path / f"beside_{index}" for index in range(4)]
    for scene, folder in zip(scenes, alone, strict=True):
        run(scene, folder)
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(run, [*scenes, *scenes], beside))
    for index, folder in enumerate(beside):
        other = alone[index % 2]
        assert said(folder) == said(other)
        with h5py.File(folder / "results.h5") as a, h5py.File(other / "results.h5") as b:
            assert np.array_equal(a["diaphragm/position"][()], b["diaphragm/position"][()])


def said(folder: Path) -> list[str]:
    """Lines of the log without their times."""
    lines = [line.split(" ", 2)[2] for line in (folder / "log.txt").read_text().splitlines()]
    assert lines
    return lines
