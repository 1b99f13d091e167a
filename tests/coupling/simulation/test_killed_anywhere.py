"""A run killed at ten random moments, settling or writing, is the one that was never killed."""

from __future__ import annotations

import random
import re
import subprocess
import sys
import time
from pathlib import Path

import h5py
import numpy as np
from small_scene import SMALL

EDT = [sys.executable, "-c", "from coupling.cli.entry import main; main()"]
SCENE = f"""\
{SMALL}[model]
fluid = "hydrostatic"
[cloth]
resolution = 8
[time]
settle = 1.0
duration = 2.0
step = 0.01
output_every = 2
checkpoint_every = 3
"""
KILLS, LONGEST = 10, 1.2  # seconds after the start of the work


def killed(words: list[str], folder: Path, after: float) -> None:
    """Kill the command ``after`` seconds of work in ``folder``, if it is not done before."""
    with subprocess.Popen([*EDT, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE) as run:
        end = time.monotonic() + 120
        (folder / ".lock").unlink(missing_ok=True)  # of the process killed before
        while not (folder / ".lock").is_file() and run.poll() is None:
            assert time.monotonic() < end
            time.sleep(0.005)
        time.sleep(after)
        run.kill()


def test_a_run_killed_at_random_moments_goes_on_by_what_it_says(tmp_path: Path) -> None:
    """Killed while settling, neither ``run`` nor ``resume`` took the folder."""
    (tmp_path / "scene.toml").write_text(SCENE)
    whole, run = tmp_path / "whole", tmp_path / "run"
    start = ["run", str(tmp_path), "-o", str(run)]
    subprocess.run([*EDT, *start[:3], str(whole)], check=True, capture_output=True)
    chance, words = random.Random(5), start
    for _ in range(KILLS):
        killed(words, run, chance.uniform(0.0, LONGEST))
        if (run / "scene.toml").is_file():  # otherwise the same command starts
            refused = subprocess.run([*EDT, *start], capture_output=True, text=True)
            assert refused.returncode == 2
            said = re.search(r"Go on with it: edt (resume \S+);", refused.stderr)
            assert said, refused.stderr
            words = said[1].split()
    done = subprocess.run([*EDT, *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    with h5py.File(run / "results.h5") as one, h5py.File(whole / "results.h5") as other:
        names: list[str] = []
        other.visititems(lambda name, item: names.append(name) if hasattr(item, "shape") else None)
        assert "diaphragm/position" in names
        for name in names:
            assert np.array_equal(one[name][()], other[name][()], equal_nan=True), name
