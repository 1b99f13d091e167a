"""The machine's speed, kept in the user's cache: the least that was ever measured."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from coupling.estimate import machine


@pytest.fixture
def measuring(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[float], None]:
    """An empty cache, and a way to say what a measurement gives."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))

    def gives(slowness: float) -> None:
        machine.slowness.cache_clear()
        monkeypatch.setattr(machine, "_measured", lambda: slowness)

    yield gives
    machine.slowness.cache_clear()


def test_the_least_is_kept(measuring: Callable[[float], None]) -> None:
    """A run beside others makes the machine look slow; it must not stay so."""
    for now in (1.5, 1.2, 1.9):
        measuring(now)
        machine.remember_speed()
    measuring(3.0)
    assert machine.slowness() == 1.2


def test_what_is_not_kept_is_measured_and_nothing_is_written(
    measuring: Callable[[float], None], tmp_path: Path
) -> None:
    measuring(1.7)
    assert machine.slowness() == 1.7
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("text", ["", "[]", '{"slowness": null}', '{"slowness": -1}', "{"])
def test_a_damaged_file_is_measured_anew(
    measuring: Callable[[float], None], tmp_path: Path, text: str
) -> None:
    measuring(1.4)
    machine.remember_speed()
    (kept,) = tmp_path.rglob("speed-*.json")
    kept.write_text(text)
    measuring(1.6)
    assert machine.slowness() == 1.6
    machine.remember_speed()
    assert json.loads(kept.read_text()) == {"slowness": 1.6}


def test_a_cache_that_cannot_be_written_stops_nothing(
    measuring: Callable[[float], None], tmp_path: Path
) -> None:
    (tmp_path / "diaphragm-tank").write_text("no folder")
    measuring(1.1)
    machine.remember_speed()
    assert machine.slowness() == 1.1
