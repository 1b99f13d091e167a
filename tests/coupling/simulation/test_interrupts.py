"""Ctrl-C, SIGTERM and SIGHUP at any moment: status 130, a summary, and a run to go on with."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from small_scene import SMALL

from coupling.simulation import interrupts

SCENE = f"""\
{SMALL}[model]
fluid = "hydrostatic"
[cloth]
resolution = 8
[time]
settle = 1.0
duration = 60
step = 0.01
checkpoint_every = 5
"""
EDT = """
from coupling.simulation.interrupts import exit_at_once
exit_at_once()
print("ready", flush=True)
from coupling.cli.entry import main
main()
"""


def started(*words: object, **options: object) -> subprocess.Popen[str]:
    """The command, from the moment on at which it can be interrupted."""
    process = subprocess.Popen(
        [sys.executable, "-c", EDT, *map(str, words)], stdout=subprocess.PIPE, text=True,
        **({"stderr": subprocess.PIPE} | options),
    )  # fmt: skip
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    return process


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    (tmp_path / "scene.toml").write_text(SCENE)
    return tmp_path


def wait_for(file: Path, process: subprocess.Popen[str]) -> None:
    end = time.monotonic() + 120
    while not file.is_file():
        assert process.poll() is None
        assert time.monotonic() < end
        time.sleep(0.01)


@pytest.mark.parametrize("share", [0.0, 0.1, 0.2, 0.4, 0.6])
def test_an_interrupt_while_modules_are_imported_is_quiet(scene: Path, share: float) -> None:
    """It ended in a traceback. ``share``: of the time that the command takes by itself."""
    begun = time.monotonic()
    assert started("check", scene).wait(timeout=60) == 0
    whole = time.monotonic() - begun
    process = started("check", scene)
    time.sleep(share * whole)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert errors == "interrupted\n"
    assert process.returncode == 130


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("file", ["coupling.csv", "checkpoint.h5"])  # while settling, and later
def test_a_signal_leaves_a_summary(scene: Path, number: signal.Signals, file: str) -> None:
    """SIGHUP, of a terminal that closes, left none."""
    run = scene / "run"
    process = started("run", scene, "-o", run)
    wait_for(run / file, process)
    time.sleep(0.1)
    process.send_signal(number)
    if number != signal.SIGINT:
        process.send_signal(number)  # a closing terminal sends it twice
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert f"Go on with: edt resume {run}" in errors
    assert json.loads((run / "summary.json").read_text())["status"] == "interrupted"
    assert not (run / ".lock").exists()


@pytest.fixture
def raising() -> Iterator[None]:
    """Signals raise ``KeyboardInterrupt`` as they do within a verb."""
    handlers = {number: signal.getsignal(number) for number in interrupts._SIGNALS}
    interrupts.exit_at_once()
    interrupts.raise_interrupt()
    try:
        yield
    finally:
        interrupts._raised.clear()
        for number, handler in handlers.items():
            signal.signal(number, handler)


def test_an_interrupt_within_a_finalizer_is_not_lost(
    raising: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A run went on to its end where the signal came while a weak reference was cleared."""

    class Left:
        def __del__(self) -> None:
            signal.raise_signal(signal.SIGTERM)

    monkeypatch.setattr(sys, "unraisablehook", lambda _: None)
    Left()
    with pytest.raises(KeyboardInterrupt):
        interrupts.raise_lost_interrupt()
    interrupts.raise_interrupt()
    interrupts.raise_lost_interrupt()


def test_an_interrupt_that_compiled_code_wraps_is_one(raising: None) -> None:
    """Numba's dispatcher made a SystemError of it, and the run ended in a traceback."""

    def compiled() -> None:
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt as interrupt:
            raise SystemError("returned a result with an exception set") from interrupt

    with pytest.raises(KeyboardInterrupt), interrupts.wrapped_interrupts_raised():
        compiled()


def test_an_error_without_an_interrupt_stays_one(raising: None) -> None:
    with pytest.raises(SystemError), interrupts.wrapped_interrupts_raised():
        raise SystemError("of its own")


def test_a_closed_terminal_leaves_a_summary(scene: Path) -> None:
    """The progress bar has nowhere to be drawn then, nor has a message."""
    run = scene / "run"
    leader, follower = pty.openpty()
    process = started("run", scene, "-o", run, stderr=follower, start_new_session=True)
    os.close(follower)
    wait_for(run / "checkpoint.h5", process)
    os.close(leader)
    process.send_signal(signal.SIGHUP)
    process.communicate(timeout=60)
    assert process.returncode == 130
    assert json.loads((run / "summary.json").read_text())["status"] == "interrupted"


def test_nohup_is_heeded(scene: Path) -> None:
    run = scene / "run"
    process = started("run", scene, "-o", run, preexec_fn=_ignore_hangup)
    wait_for(run / "checkpoint.h5", process)
    process.send_signal(signal.SIGHUP)
    time.sleep(1.0)
    assert process.poll() is None
    process.kill()
    process.communicate()


def _ignore_hangup() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
