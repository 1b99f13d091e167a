"""``edt check`` starts no process and writes nothing, whatever the scene names."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

CASE = Path(__file__).parents[3] / "foam_cases" / "pad_sway_coarse" / "scene.toml"
WATCHED = """\
import json, os, sys
seen = []
STARTS = {"subprocess.Popen", "os.system", "os.exec", "os.posix_spawn", "os.fork", "os.spawn"}
CHANGES = {"os.mkdir", "os.remove", "os.rename", "os.rmdir", "os.truncate", "os.chmod", "os.link",
           "os.symlink", "shutil.copyfile", "shutil.rmtree", "tempfile.mkstemp", "tempfile.mkdtemp"}
def watch(event, arguments):
    if arguments and (arguments[0] == "uname" or "/dev/null" in str(arguments)):
        return  # h5py asks for the machine's kind when it is imported
    if event in STARTS | CHANGES:
        seen.append([event, str(arguments)])
    if event == "open" and arguments[2] & (os.O_WRONLY | os.O_RDWR | os.O_CREAT):
        seen.append([event, str(arguments)])
sys.addaudithook(watch)
from coupling.cli.main import main
try:
    main()
finally:
    print(json.dumps(seen), file=sys.stderr)
"""


def watched(*arguments: object) -> tuple[int, str, list[list[str]]]:
    """Exit status, stdout, and all that was started or written."""
    done = subprocess.run(
        [sys.executable, "-B", "-c", WATCHED, *map(str, arguments)],
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    return done.returncode, done.stdout, json.loads(done.stderr.splitlines()[-1])


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """Folder of a scene with a flow."""
    (tmp_path / "scene.toml").write_text(CASE.read_text())
    return tmp_path


@pytest.mark.openfoam
def test_a_right_scene_is_checked_without_starting_or_writing(case: Path):
    status, said, seen = watched("check", case)
    assert status == 0
    assert "advised" in said
    assert seen == []
    assert [path.name for path in case.iterdir()] == ["scene.toml"]


@pytest.mark.openfoam
@pytest.mark.parametrize("allowed", [False, True])
def test_a_scene_that_names_a_program_does_not_start_it(case: Path, allowed: bool):
    program = case / "solver"
    program.write_text(f"#!/bin/sh\ntouch '{case}/started'\n")
    program.chmod(0o755)
    text = (case / "scene.toml").read_text()
    (case / "scene.toml").write_text(
        text.replace("[openfoam]", f'[openfoam]\ncommand = "{program}"')
    )
    status, _, seen = watched("check", case, *["--allow-command"] * allowed)
    assert status == (0 if allowed else 2)
    assert seen == []
    assert not (case / "started").exists()
