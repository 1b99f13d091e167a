"""No figure of a summary depends on how often the fields are written out."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from small_scene import SMALL

from coupling.scene.scene import Scene, load_scene
from coupling.simulation.driver import resume, run
from coupling.store.results import read_results
from coupling.store.run_record import read_summary

EVERY = (1, 2, 4)
STEPS = 112  # 2.24 periods
STOP = 0.575  # s, after the 57th step: neither at a checkpoint nor an instant of output
COSTS = ("wall_s", "cpu_s", "wall_by_part", "flow_fields_bytes")


def scene_in(folder: Path, fluid: str, every: int) -> Scene:
    folder.mkdir(parents=True)
    (folder / "scene.toml").write_text(f"""\
{SMALL.replace("amplitude = 0.002", "amplitude = 0.01")}[model]
fluid = "{fluid}"
[cloth]
resolution = 8
[time]
settle = 1.0
duration = {0.01 * STEPS}
step = 0.01
output_every = {every}
checkpoint_every = 5
""")
    return load_scene(folder)


def figures(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """Every figure of a summary by its place, but those of what it cost."""
    if isinstance(value, dict):
        for key, part in value.items():
            if key not in COSTS:
                yield from figures(part, f"{name}.{key}")
    elif isinstance(value, list | tuple):
        for place, part in enumerate(value):
            yield from figures(part, f"{name}[{place}]")
    else:
        yield name, value


def assert_same(summary: dict[str, Any], other: dict[str, Any]) -> None:
    one, two = dict(figures(summary)), dict(figures(other))
    assert one.keys() == two.keys()
    for name, value in one.items():
        if isinstance(value, float):
            assert two[name] == pytest.approx(value, rel=1e-12, abs=0.0), name
        else:
            assert two[name] == value, name


def stopped(_: str, time: float, *__: object) -> None:
    if time > STOP:
        raise KeyboardInterrupt


KILLED = f"""
import os, signal, sys
from pathlib import Path
from coupling.scene.scene import load_scene
from coupling.simulation.driver import run
def progress(_, time, *__):
    if time > {STOP}:
        os.kill(os.getpid(), signal.SIGKILL)
folder = Path(sys.argv[1])
run(load_scene(folder), folder, progress=progress)
"""


@pytest.mark.parametrize("fluid", ["hydrostatic", "potential"])
def test_the_summary_is_the_same_however_often_and_however_broken(
    tmp_path: Path, fluid: str
) -> None:
    whole: dict[str, Any] = {}
    halves = []
    for every in EVERY:
        scene = scene_in(tmp_path / f"{every}", fluid, every)
        summary = run(scene, tmp_path / f"{every}")
        whole = whole or summary
        assert_same(summary, whole)
        results = read_results(tmp_path / f"{every}")
        assert np.allclose(results.time, results.steps.time[::every], rtol=1e-12)
        assert len(results.steps.time) == STEPS + 1

        broken = tmp_path / f"{every}-broken"
        scene = scene_in(broken, fluid, every)
        with pytest.raises(KeyboardInterrupt):
            run(scene, broken, progress=stopped)
        results = read_results(broken)
        assert results.time[-1] == results.steps.time[-1]  # the last step is written out
        half = read_summary(broken)
        assert (half["status"], half["steps"]) == ("interrupted", 58)
        halves.append(half)
        assert_same(resume(broken), whole)
        again = read_results(broken)
        assert np.allclose(again.time, again.steps.time[::every], rtol=1e-12)
    assert whole["status"] == "completed"
    assert whole["cg"]["drift"] is not None
    assert whole["energy"]["per_period"]["dissipated_J"] > 0.0
    for half in halves:
        assert_same(half, halves[0])

    killed = tmp_path / "killed"
    scene_in(killed, fluid, 4)
    done = subprocess.run(
        [sys.executable, "-c", KILLED, str(killed)], cwd=Path(__file__).parents[3], check=False
    )
    assert done.returncode == -signal.SIGKILL
    left = read_results(killed)
    assert len(left.steps.time) > 5  # up to the last checkpoint at the least
    assert_same(resume(killed), whole)
