"""A terminal of the C locale, and texts and paths that it has no letters for."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from coupling.scene.scene import load_scene

SCENE = """\
title = "Püre “µ” — 35 inch"
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
frequency = 1.25
amplitude = 0.25
[model]
fluid = "hydrostatic"
[cloth]
resolution = 4
[time]
duration = 0.02
"""
ASCII = {"LC_ALL": "C", "PYTHONIOENCODING": "ascii", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
UTF8 = {"LC_ALL": "C.UTF-8", "PYTHONIOENCODING": "utf-8"}


def edt(folder: Path, environment: dict[str, str], *arguments: str | bytes) -> str:
    """What the verb prints; it ends as it should."""
    done = subprocess.run(
        [sys.executable, "-c", "from coupling.cli.main import main; main()", *arguments],
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])} | environment,
        cwd=folder, capture_output=True, timeout=120,
    )  # fmt: skip
    said = (done.stdout + done.stderr).decode(errors="replace")
    wrong = "no" in str(arguments[1:2])
    assert done.returncode == (2 if wrong else 0), said
    assert "Traceback" not in said
    assert "Logging error" not in said
    return said


@pytest.fixture(scope="module")
def case(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Working folder with a scene whose title has other letters."""
    folder = tmp_path_factory.mktemp("case")
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    return folder


@pytest.mark.parametrize(
    ("environment", "name"),
    [(ASCII, "läuft".encode()), (ASCII, b"byte-\xff"), (UTF8, b"byte-\xff")],
    ids=["ascii, umlaut", "ascii, byte", "utf-8, byte"],
)
def test_every_verb_prints_what_it_can(case: Path, environment: dict[str, str], name: bytes):
    folder = name + environment["LC_ALL"].encode()
    edt(case, environment, "run", "scene.toml", b"-o", folder)
    written = case / os.fsdecode(folder)
    assert load_scene(written).title == "Püre “µ” — 35 inch"
    assert "Püre" in (written / "report.html").read_text(encoding="utf-8")
    (written / "report.html").unlink()
    edt(case, environment, "report", folder)
    assert (written / "report.html").is_file()
    edt(case, environment, "check", folder)
    edt(case, environment, "check", folder, "--json")
    edt(case, environment, "check", b"no-" + name)
