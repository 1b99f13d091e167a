"""Compiled functions come from the disk, unless what is there is damaged or nothing can be kept."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

MODULE = """\
from cloth.compiled import compiled

@compiled
def inner(x):
    return 2.0 * x

@compiled
def outer(x):
    return inner(x) + 1.0
"""
CODE = """\
import logging, sys
logging.basicConfig(format="%(message)s")
from kept import inner, outer
print(outer(3.0), sum(outer.stats.cache_hits.values()))
"""
KEPT, COMPILED = "7.0 1\n", "7.0 0\n"


def run(folder: Path, **environment: str) -> "subprocess.CompletedProcess[str]":
    """Call the compiled function in a process of its own."""
    (folder / "kept.py").write_text(MODULE)
    path = os.pathsep.join([str(folder), str(Path(__file__).parents[2])])
    known = {name: value for name, value in os.environ.items() if not name.startswith("NUMBA_")}
    done = subprocess.run(
        [sys.executable, "-B", "-c", CODE],
        env={**known, "PYTHONPATH": path, **environment},
        cwd=folder, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the module and its cache."""
    folder = tmp_path_factory.mktemp("kept")
    assert run(folder).stdout == COMPILED
    assert run(folder).stdout == KEPT
    return folder


@pytest.fixture
def copy(kept: Path, tmp_path: Path) -> Path:
    """A copy of it, whose files may be damaged."""
    shutil.copytree(kept, tmp_path / "kept")
    return tmp_path / "kept"


def flip(content: bytes) -> bytes:
    """One bit in the middle is another."""
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 1]) + content[middle + 1 :]


DAMAGE = {
    "emptied": lambda content: b"",
    "cut": lambda content: content[: len(content) // 2],
    "garbage": lambda content: b"garbage" * 100,
    "a bit flipped": flip,
}


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("ending", ["nbi", "nbc"])
def test_damaged_files_are_compiled_again(copy: Path, damage: str, ending: str):
    files = [path for path in (copy / "__pycache__").glob(f"*.{ending}") if "outer" in path.name]
    assert files
    for path in files:
        path.write_bytes(DAMAGE[damage](path.read_bytes()))
    done = run(copy)
    assert done.stdout == COMPILED
    assert f"{files[0]}: damaged. It is compiled again." in done.stderr
    assert run(copy).stdout == KEPT


def test_nothing_is_kept_where_no_folder_can_be_written(tmp_path: Path):
    (tmp_path / "__pycache__").write_text("a file in the way")
    done = run(tmp_path, HOME="/dev/null", XDG_CACHE_HOME="/dev/null", NUMBA_CACHE_DIR="/dev/null")
    assert done.stdout == COMPILED
    assert done.stderr.count("Compiled functions are not kept") == 1


def test_finder_that_is_not_there(tmp_path: Path):
    assert run(tmp_path, NUMBA_CACHE_LOCATOR_CLASSES="nonsense.Finder").stdout == COMPILED


def test_cache_folder_that_is_a_file(tmp_path: Path):
    (tmp_path / "file").touch()
    assert run(tmp_path, NUMBA_CACHE_DIR=str(tmp_path / "file")).stdout == COMPILED


def test_full_disk_is_said_and_the_result_stands(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (tmp_path / "sitecustomize.py").write_text(
        "import builtins\nopen_ = open\n"
        "def full(path, *rest, **more):\n"
        "    if '.tmp.' in str(path): raise OSError(28, 'No space left on device', str(path))\n"
        "    return open_(path, *rest, **more)\n"
        "builtins.open = full\n"
    )
    done = run(tmp_path)
    assert done.stdout == COMPILED
    assert "No space left on device" in done.stderr


def test_without_a_home_no_folder_is_made_of_a_tilde(tmp_path: Path):
    """A user without an entry in the list of users, and no HOME."""
    (tmp_path / "__pycache__").write_text("a file in the way")
    (tmp_path / "sitecustomize.py").write_text(
        "import os, pwd\nos.environ.pop('HOME', None)\n"
        "def none(uid): raise KeyError(uid)\npwd.getpwuid = none\n"
    )
    assert run(tmp_path).stdout == COMPILED
    assert not (tmp_path / "~").exists()
