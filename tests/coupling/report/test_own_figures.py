"""Reports are made the same whatever a user has set for their own figures."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

CODE = """\
import hashlib, sys
from coupling.report.style import house_style, new_figure, svg
with house_style():
    figure = new_figure()
    figure.add_subplot().plot([0, 1], label="one two")
    print(hashlib.sha256(svg(figure).encode()).hexdigest())
"""
SETTINGS = "text.usetex: True\nfont.size: 30\nlines.linewidth: 9\nsavefig.dpi: 7\nnonsense\n"


def drawn(folder: Path, code: str = CODE, **environment: str) -> str:
    """What is drawn, in ``folder``."""
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": str(Path(__file__).parents[3])} | environment,
        cwd=folder, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def usual(tmp_path_factory: pytest.TempPathFactory) -> str:
    """What is drawn where nothing is set."""
    return drawn(tmp_path_factory.mktemp("usual"))


@pytest.mark.parametrize(
    "backend", ["module://matplotlib_inline.backend_inline", "nonsense", "TkAgg"]
)
def test_backend_of_the_user(tmp_path: Path, usual: str, backend: str):
    assert drawn(tmp_path, MPLBACKEND=backend) == usual


@pytest.mark.parametrize("content", [SETTINGS.encode(), b"\xff\xfe\x00bad"], ids=["tex", "binary"])
@pytest.mark.parametrize("place", ["variable", "working folder", "configuration"])
def test_settings_of_the_user(tmp_path: Path, usual: str, content: bytes, place: str):
    (tmp_path / "work").mkdir()
    (tmp_path / "set").mkdir()
    folder = tmp_path / ("work" if place == "working folder" else "set")
    (folder / "matplotlibrc").write_bytes(content)
    name = {"variable": "MATPLOTLIBRC", "configuration": "MPLCONFIGDIR"}.get(place, "UNUSED")
    assert drawn(tmp_path / "work", **{name: str(folder)}) == usual


def test_configuration_folder_that_cannot_be_written(tmp_path: Path, usual: str):
    (tmp_path / "file").touch()
    assert drawn(tmp_path, MPLCONFIGDIR=str(tmp_path / "file")) == usual


def test_settings_that_a_program_has_loaded(tmp_path: Path, usual: str):
    """In a notebook; they are the same again afterwards."""
    before = "import matplotlib\nmatplotlib.rcParams.update({'text.usetex': True})\n"
    after = "assert matplotlib.rcParams['text.usetex']\n"
    assert drawn(tmp_path, before + CODE + after) == usual
