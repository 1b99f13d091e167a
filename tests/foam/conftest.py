"""A scene so small that a run takes seconds, and the real command to run it with."""

from __future__ import annotations

import os
import subprocess
import sys
import warnings
from collections.abc import Callable
from pathlib import Path

import pytest

from coupling.foam.build import build_solver
from coupling.foam.debian_source import NoHeaders
from coupling.foam.installation import find_openfoam
from coupling.foam.process import OpenFoam

EDT = [sys.executable, "-c", "from coupling.cli.main import main; main()"]
SCENE = """\
[tank]
radius = 0.4445
[diaphragm]
thickness = 0.001778
density = 1070.0
youngs_modulus = 8.6e6
poisson_ratio = 0.5
[liquid]
density = 1000.0
viscosity = 1.0e-6
fill_fraction = 0.8
[motion]
kind = "sine"
frequency = 1.25
amplitude = 0.05
[cloth]
resolution = 6
[openfoam]
cells = 176
[time]
settle = 0.5
duration = 0.06
step = 0.005
output_every = 1
checkpoint_every = 3
"""

Edt = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def edt() -> Edt:
    """Call the command; its output is text without colours."""

    def call(*arguments: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [*EDT, *map(str, arguments)],
            capture_output=True, text=True, timeout=300, env=os.environ | {"NO_COLOR": "1"},
        )  # fmt: skip

    return call


@pytest.fixture(scope="session")
def alive() -> OpenFoam:
    """OpenFOAM with the solver that stays alive, built now if need be."""
    try:
        build_solver(find_openfoam())
    except NoHeaders as reason:  # without a network; a solver that does not compile is a failure
        warnings.warn(f"NOT TESTED: the solver that stays alive. {reason}", stacklevel=1)
        pytest.skip(f"NOT TESTED: the solver that stays alive. {reason}")
    return find_openfoam(keep_alive=True)


@pytest.fixture(scope="session")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the tiny scene."""
    folder = tmp_path_factory.mktemp("scene")
    (folder / "scene.toml").write_text(SCENE)
    return folder


@pytest.fixture(scope="session")
def unbroken(edt: Edt, scene: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the tiny scene's run, done in one go."""
    folder = tmp_path_factory.mktemp("unbroken") / "run"
    done = edt("run", scene, "-o", folder)
    assert done.returncode == 0, done.stderr
    return folder
