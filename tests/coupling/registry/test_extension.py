"""A liquid, a coupling scheme, a kind of motion and a verification case of one's own.

Each is one file and one line in a list; a scene and the command line take it by its name, and
nothing is left of it once it is removed.
"""

import json
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from coupling.cli.main import app
from coupling.fluids import FLUIDS
from coupling.motion import MOTIONS
from coupling.registry import Registry
from coupling.scene.errors import SceneError
from coupling.scene.scene import scene_from
from coupling.schemes import SCHEMES
from coupling.verify import CASES

SCENE = """
[tank]
radius = 0.4445
[diaphragm]
material = "AF-E-332"
thickness = 0.001778
[liquid]
name = "water"
fill_fraction = 0.8
[motion]
kind = "sine"
frequency = 1.0
amplitude = 0.01
[model]
fluid = "hydrostatic"
[cloth]
resolution = 6
[time]
duration = 0.1
step = 0.02
output_every = 1
"""

LIQUID = '''
"""Liquid that does not feel the tank's acceleration: its pressure is that of rest."""

import numpy as np

from coupling.fluids.hydrostatic import hydrostatic_of
from coupling.fluids.model import FluidModel


class Still:
    def __init__(self, scene):
        self.liquid, self.gravity = hydrostatic_of(scene), np.array(scene.gravity)

    def load(self, body_force, volume):
        return self.liquid.load(self.gravity, volume)


class StillModel(FluidModel):
    name = "still"

    def load_model(self, scene):
        return Still(scene)


ENTRY = StillModel()
'''

SCHEME = '''
"""The plain fixed point of a structure that carries the liquid's inertia, with less of a step."""

from coupling.schemes.fixed_point import FixedPoint


class Damped(FixedPoint):
    takes_inertia = True
    typical_iterations = 6.0

    @classmethod
    def of(cls, settings):
        return cls(0.9)


ENTRY = Damped
'''

MOTION = '''
"""A tank that falls freely from time 0 on."""

import numpy as np

from coupling.motion.kind import MotionKind
from coupling.motion.rest import RestMotion


class Falling(RestMotion):
    def acceleration(self, time):
        return np.array([0.0, 0.0, -1.0])

    def step_acceleration(self, start, end, previous):
        return self.acceleration(end)

    working_acceleration = lambda self, start, end: self.acceleration(end)


class Fall(MotionKind):
    def motion(self, section):
        return Falling()

    def peak_accelerations(self, section):
        return np.array([[0.0, 0.0, -1.0]])

    def facts(self, section):
        return ((1.0, "m/s² down"),)


ENTRY = Fall()
'''

CASE = '''
"""Two and two."""

from coupling.verify.case import VerifyResult, quantity


def sum_of(*, count: int = 2) -> VerifyResult:
    found = quantity("sum", float(sum([2.0] * count)), 2.0 * count)
    return VerifyResult(case="sum", options={"count": count}, quantities=(found,), wall_s=0.0)


ENTRY = sum_of
'''

Listed = Callable[[Registry, str, str], None]


@pytest.fixture
def listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Listed]:
    """Puts a file beside the scene and its line into a list; takes both away in the end."""
    monkeypatch.syspath_prepend(tmp_path)
    added: list[tuple[Registry, str]] = []

    def add(registry: Registry, name: str, text: str) -> None:
        module = f"own_{name}"
        (tmp_path / f"{module}.py").write_text(text)
        registry.add(name, f"{module}:ENTRY")
        added.append((registry, name))

    yield add
    for registry, name in added:
        registry.remove(name)
        sys.modules.pop(f"own_{name}", None)


def edt(*words: str) -> str:
    """What the command prints; it has to succeed."""
    done = CliRunner().invoke(app, list(words))
    assert done.exit_code == 0, done.output
    return done.stdout


def summary_of(tmp_path: Path, *changes: str) -> dict:
    """Summary of a run by the command line, its report written too."""
    (tmp_path / "scene.toml").write_text(SCENE)
    sets = [word for change in changes for word in ("--set", change)]
    out = str(tmp_path / "run")
    found = json.loads(edt("run", str(tmp_path), "-o", out, "--force", "--json", *sets))
    assert (tmp_path / "run" / "report.html").is_file()
    return found


def test_a_liquid_is_a_file_and_a_line(tmp_path: Path, listed: Listed):
    listed(FLUIDS, "still", LIQUID)
    shaken = summary_of(tmp_path)
    still = summary_of(tmp_path, "model.fluid=still")
    assert still["status"] == "completed"
    assert still["model"] == "still"
    # what is left of the motion is the rubber's own inertia, a hundredth of the liquid's
    assert still["cg"]["amplitude_m"][0] < 0.1 * shaken["cg"]["amplitude_m"][0]


def test_a_motion_is_a_file_and_a_line(tmp_path: Path, listed: Listed):
    listed(MOTIONS, "fall", MOTION)
    found = summary_of(tmp_path, "motion.kind=fall")
    assert found["status"] == "completed"
    (tmp_path / "scene.toml").write_text(SCENE)
    checked = json.loads(edt("check", str(tmp_path), "--set", "motion.kind=fall", "--json"))
    assert checked["numbers"]["acceleration_ratio"] == pytest.approx(1.0 / 9.81)


def test_a_case_is_a_file_and_a_line(listed: Listed):
    listed(CASES, "sum", CASE)
    found = json.loads(edt("verify", "sum", "--count", "3", "--json"))
    assert "sum" in json.dumps(found)
    assert "6.0" in json.dumps(found)


@pytest.mark.openfoam
def test_a_scheme_is_a_file_and_a_line(tmp_path: Path, listed: Listed):
    listed(SCHEMES, "damped", SCHEME)
    found = summary_of(
        tmp_path, "coupling.scheme=damped", "model.fluid=openfoam", "openfoam.cells=176",
        "time.duration=0.04", "coupling.tolerance=1e-8",
    )  # fmt: skip
    assert found["status"] == "completed"
    assert found["coupling"]["scheme"] == "damped"
    assert found["coupling"]["unconverged_steps"] == 0
    # an iteration leaves a tenth of the residual and what the inertia does not know
    assert 2 <= found["coupling"]["iterations_mean"] <= 12


@pytest.mark.parametrize(
    ("key", "section", "names"),
    [("fluid", "model", FLUIDS), ("kind", "motion", MOTIONS), ("scheme", "coupling", SCHEMES)],
)
def test_a_name_that_is_not_listed_is_refused_with_those_that_are(key, section, names):
    with pytest.raises(SceneError) as error:
        scene_from(
            {
                "tank": {"radius": 0.4},
                "diaphragm": {"material": "AF-E-332", "thickness": 0.001},
                "liquid": {"name": "water", "fill_fraction": 0.5},
                "time": {"duration": 1.0},
                section: {key: "none"},
            }
        )
    assert f"{section}.{key}: must be one of" in str(error.value)
    for name in names:
        assert f'"{name}"' in str(error.value)


def test_a_name_is_listed_once():
    with pytest.raises(ValueError, match="already"):
        FLUIDS.add("hydrostatic", "elsewhere:ENTRY")
