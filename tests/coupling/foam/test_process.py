"""Programs that are missing, fail, die or hang: one error with the log's tail, nothing left."""

import os
import signal
import threading
import time
from pathlib import Path

import pytest

from coupling.foam.process import (
    OpenFoam,
    OpenFoamFailed,
    log_tail,
    run_program,
)


@pytest.fixture
def run(tmp_path):
    """Run a shell script as the solver; the case's folder has a blank in its name."""
    case = tmp_path / "a case"
    case.mkdir()

    def call(script, timeout=20.0):
        program = tmp_path / "solver"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(0o755)
        openfoam = OpenFoam(solver=program, project_dir=tmp_path, version="none")
        run_program(
            program, case, openfoam=openfoam, log=case / "log", timeout=timeout, moment="t = 1 s"
        )
        return (case / "log").read_text()

    return call


def alive(process):
    """Whether the process of this number runs; a zombie does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_output_arguments_and_surroundings(run, tmp_path):
    log = run(
        'echo "$0 $1 $2"; pwd -P; echo $PWD; echo $WM_PROJECT_DIR $OMP_NUM_THREADS; echo no >&2'
    )
    case = str(tmp_path / "a case")
    assert log.splitlines() == [
        f"{tmp_path}/solver -case /proc/self/cwd", case, "/proc/self/cwd", f"{tmp_path} 1", "no",
    ]  # fmt: skip


def test_standard_input_is_closed(run):
    assert run("cat; echo end") == "end\n"


def test_exit_status_is_named_with_the_tail(run):
    with pytest.raises(OpenFoamFailed) as caught:
        run("for i in $(seq 40); do echo line $i; done; echo 'FOAM FATAL ERROR' >&2; exit 1")
    text = str(caught.value)
    assert text.startswith("t = 1 s: solver ended with exit status 1. ")
    assert text.endswith("    line 40\n    FOAM FATAL ERROR")
    assert "line 26\n" not in text


def test_death_by_signal_is_named(run):
    with pytest.raises(OpenFoamFailed, match=r"signal 9(.|\n)*so far"):
        run("echo so far; kill -9 $$")


def test_hang_is_ended_in_time_with_all_that_it_started(run, tmp_path):
    start = time.monotonic()
    with pytest.raises(OpenFoamFailed, match=r"no answer within 0.5 s(.|\n)*time step 1"):
        run(f"echo time step 1; sleep 600 & echo $$ $! > '{tmp_path}/ids'; wait", timeout=0.5)
    assert time.monotonic() - start < 5.0
    processes = [int(text) for text in (tmp_path / "ids").read_text().split()]
    assert len(processes) == 2
    until = time.monotonic() + 2.0
    while any(map(alive, processes)) and time.monotonic() < until:
        time.sleep(0.01)
    assert not any(map(alive, processes))


def test_deaf_hang_is_ended_too(run):
    with pytest.raises(OpenFoamFailed, match="no answer"):
        run("trap '' TERM INT HUP; while :; do sleep 0.1; done", timeout=0.5)


def test_missing_program(run, tmp_path):
    openfoam = OpenFoam(solver=tmp_path / "none", project_dir=tmp_path, version="none")
    with pytest.raises(OpenFoamFailed, match="cannot be started"):
        run_program(
            openfoam.solver, tmp_path, openfoam=openfoam, log=tmp_path / "log", timeout=1,
            moment="t = 0 s",
        )  # fmt: skip


def test_log_tail_of_nothing(tmp_path):
    assert "no output" in log_tail(tmp_path / "none")
    (tmp_path / "log").write_bytes(b"\xff\xfe broken\n")
    assert "broken" in log_tail(tmp_path / "log")


def test_interrupt_ends_the_solver(run, tmp_path):
    def interrupt():
        while not (tmp_path / "id").exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=interrupt, daemon=True)
    thread.start()
    with pytest.raises(KeyboardInterrupt):
        run(f"echo $$ > '{tmp_path}/new'; mv '{tmp_path}/new' '{tmp_path}/id'; exec sleep 600")
    assert not alive(int((tmp_path / "id").read_text()))
