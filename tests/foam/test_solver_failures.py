"""A solver that fails in the middle of a run: a reason, an exit status, and results that open."""

import json
import shutil
import time
from pathlib import Path

import h5py
import meshio
import numpy as np
import pytest

from coupling.foam.installation import find_openfoam

pytestmark = pytest.mark.openfoam

# Of the real solver before it fails: one before the run, then a few steps, beyond a checkpoint.
GOOD_CALLS = 8
FAILURES = {
    "exits": ("echo '--> FOAM FATAL ERROR: of the test'; exit 1", "exit status 1"),
    "hangs": ("echo 'hangs now: of the test'; sleep 600 & echo $! > '{place}/id'; wait",
              "no answer within 4 s"),
    "dies": ("echo 'dies now: of the test'; kill -9 $$", "signal 9"),
    "writes nothing": ("exit 0", "left no such field"),
    "writes rubbish": ("mkdir \"$2/$end\"; echo rubbish | tee \"$2/$end/p\" > \"$2/$end/U\"",
                       "no internalField"),
    "writes half": ('"$solver" "$@"; head -c 1500 "$2/$end/p" > "$2/p"; mv "$2/p" "$2/$end/p"',
                    "expected the values of"),
}  # fmt: skip


def solver_script(place, failure, good_calls=GOOD_CALLS):
    """A program that is the real solver for some calls, then fails."""
    program = place / "solver"
    program.write_text(
        f"""#!/bin/sh
solver={find_openfoam().solver}
[ "$1" = -help ] && exec "$solver" -help
end=$(sed -n 's/^endTime *\\(.*\\);/\\1/p' "$2/system/step")
echo call >> '{place}/calls'
[ "$(wc -l < '{place}/calls')" -le {good_calls} ] && exec "$solver" "$@"
{failure.replace("{place}", str(place))}
"""
    )
    program.chmod(0o755)
    return program


def check_results(folder):
    """The results are whole: every dataset has as many rows as there are times; XDMF reads."""
    with h5py.File(folder / "results.h5") as file:
        times = file["time"][:]
        assert len(times) >= 2
        assert (np.diff(times) > 0).all()
        position = file["diaphragm/position"][:]
        assert len(position) == len(times)
        assert np.isfinite(position).all()
        assert np.isfinite(file["liquid/force"][:]).all()
    with meshio.xdmf.TimeSeriesReader(str(folder / "results.xdmf")) as reader:
        points, _ = reader.read_points_cells()
        assert reader.num_steps == len(times)
        last, data, _ = reader.read_data(reader.num_steps - 1)
    assert len(points) == position.shape[1]
    assert last == pytest.approx(times[-1])
    assert data
    return times


@pytest.mark.parametrize("failure", FAILURES)
def test_failure_is_told_and_what_was_computed_is_kept(edt, scene, tmp_path, failure):
    script, reason = FAILURES[failure]
    program, folder = solver_script(tmp_path, script), tmp_path / "run"
    start = time.monotonic()
    done = edt("run", scene, "-o", folder, "--allow-command", "--set",
               f"openfoam.command={program}", "--set", "openfoam.timeout=4")  # fmt: skip
    assert done.returncode == 1
    assert time.monotonic() - start < 60
    assert "Traceback" not in done.stderr + done.stdout
    summary = json.loads((folder / "summary.json").read_text())
    assert summary["status"] == "failed"
    for stated in (done.stderr, summary["error"]):
        assert reason in stated
        assert "t = 0.0" in stated or "/0.0" in stated  # when: in words, or by the field's folder
        if "of the test" in script:
            assert "of the test" in stated  # the log's tail
    times = check_results(folder)
    assert summary["steps"] >= len(times) - 1
    assert 0 < times[-1] < 0.06
    if failure == "hangs":
        process = int((tmp_path / "id").read_text())
        stat = Path(f"/proc/{process}/stat")  # ended; a zombie where nobody reaps orphans
        assert not stat.exists() or stat.read_text().rsplit(")", 1)[1].split()[0] == "Z"


def test_run_goes_on_when_the_solver_is_mended(edt, scene, unbroken, tmp_path):
    program, folder = solver_script(tmp_path, "exit 1"), tmp_path / "run"
    done = edt("run", scene, "-o", folder, "--allow-command", "--set",
               f"openfoam.command={program}")  # fmt: skip
    assert done.returncode == 1
    program.unlink()
    program.symlink_to(find_openfoam().solver)
    done = edt("resume", folder, "--allow-command")
    assert done.returncode == 0, done.stderr
    assert (check_results(folder) == check_results(unbroken)).all()


def test_solver_that_fails_at_once_leaves_the_settled_state(edt, scene, tmp_path):
    program, folder = solver_script(tmp_path, "exit 3", good_calls=1), tmp_path / "run"
    done = edt("run", scene, "-o", folder, "--allow-command", "--set",
               f"openfoam.command={program}")  # fmt: skip
    assert done.returncode == 1
    assert "exit status 3" in done.stderr
    with h5py.File(folder / "results.h5") as file:
        assert file["time"][:].tolist() == [0.0]
    shutil.rmtree(folder)
