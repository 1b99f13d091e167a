"""Files of a run that were cut or replaced: status 2, the file and a mend, whatever reads them."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import h5py
import pytest
from small_scene import SMALL
from typer.testing import CliRunner

from coupling.cli.main import app

SCENE = f"""\
{SMALL}ramp = 0.0
[model]
fluid = "hydrostatic"
[cloth]
resolution = 4
tolerance = 0.001
[time]
settle = 0.3
duration = 0.1
step = 0.01
"""
STUDY = ("--models", "datum,hydrostatic", "--quick")
SWEEP = ("--over", "liquid.fill_fraction=0.7,0.8", "--workers", 1)


def edt(*words: object) -> tuple[int, str]:
    """Exit status and what was printed to a person."""
    result = CliRunner().invoke(app, [str(word) for word in words])
    assert result.exception is None or isinstance(result.exception, SystemExit), result.exc_info
    return result.exit_code, result.stderr


@pytest.fixture(scope="module")
def originals(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a scene with a run, one that chose its model, a study and a sweep of it."""
    place = tmp_path_factory.mktemp("originals")
    (place / "scene.toml").write_text(SCENE)
    assert edt("run", place, "-o", place / "run")[0] == 0
    assert edt("run", place, "-o", place / "auto", "--set", "model.fluid=auto")[0] == 0
    assert edt("study", place, *STUDY, "-o", place / "study")[0] == 0
    assert edt("sweep", place, *SWEEP, "-o", place / "sweep")[0] == 0
    return place


def cut(file: Path) -> None:
    file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])


def empty(file: Path) -> None:
    file.write_bytes(b"")


def other(file: Path) -> None:
    """Whole, but of another kind."""
    if file.suffix == ".json":
        file.write_text("{}")
    elif file.suffix == ".toml":
        file.write_text("[tank]\n")
    else:
        with h5py.File(file, "w") as content:
            content["metrics"] = 1.0


@pytest.mark.parametrize("damage", [cut, empty, other])
@pytest.mark.parametrize(
    ("verb", "file"),
    [
        ("report", "run/summary.json"),
        ("report", "run/results.h5"),
        ("report", "run/scene.toml"),
        ("report", "study/study.json"),
        ("report", "study/datum/results.h5"),
        ("report", "sweep/sweep.json"),
        ("render", "run/results.h5"),
        ("resume", "run/summary.json"),
        ("resume", "run/results.h5"),
        ("resume", "run/checkpoint.h5"),
        ("resume", "run/scene.toml"),
        ("resume", "auto/auto.json"),
        ("study", "study/datum/summary.json"),
        ("study", "study/datum/scene.toml"),
        ("study", "study/datum/results.h5"),
        ("sweep", "sweep/points/liquid.fill_fraction_0.7/potential/summary.json"),
        ("sweep", "sweep/points/liquid.fill_fraction_0.7/potential/scene.toml"),
    ],
)
def test_a_damaged_file_is_named(
    originals: Path, tmp_path: Path, verb: str, file: str, damage: Callable[[Path], None]
) -> None:
    """Most ended in a traceback, or with status 1."""
    folder = tmp_path / file.split("/")[0]
    shutil.copytree(originals / folder.name, folder)
    if file == "auto/auto.json":
        (folder / "summary.json").unlink()  # of a run that was killed, so that the choice is read
    damage(tmp_path / file)
    words: dict[str, tuple[object, ...]] = {
        "study": (originals, *STUDY, "-o", folder),
        "sweep": (originals, *SWEEP, "-o", folder),
    }
    status, errors = edt(verb, *words.get(verb, (folder,)))
    assert status == 2
    assert file.partition("/")[2].removesuffix("/scene.toml") in errors
    assert "Traceback" not in errors
