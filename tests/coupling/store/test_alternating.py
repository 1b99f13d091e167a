"""A growing file whose readers never see it half written, nor written at all."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from coupling.ports import RunFailed
from coupling.store.alternating import AlternatingFile


def extend(file: AlternatingFile, text: str) -> str:
    """Make the copy hold ``text``; what it held before."""
    with file.extending() as copy:
        former = copy.read_text()
        copy.write_text(text)
    return former


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "file").write_text("a")
    return tmp_path / "file"


def test_the_copies_take_turns(path: Path) -> None:
    """Each extension finds the file of the one before the last, and copies nothing."""
    file = AlternatingFile(path)
    found = [extend(file, text) for text in ("ab", "abc", "abcd")]
    assert found == ["a", "a", "ab"]
    assert path.read_text() == "abcd"
    file.close()
    assert list(path.parent.iterdir()) == [path]


def test_what_a_reader_has_open_is_not_written_to(path: Path) -> None:
    """``cp`` of a running folder takes time: the file it reads must stay as it was."""
    file = AlternatingFile(path)
    extend(file, "ab")
    with path.open() as reader:
        found = [extend(file, text) for text in ("abc", "abcd", "abcde")]
        assert reader.read() == "ab"
    assert found == ["a", "abc", "abc"]
    file.close()


def test_without_hard_links_the_file_is_copied(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise PermissionError

    monkeypatch.setattr(os, "link", refused)
    file = AlternatingFile(path)
    assert [extend(file, text) for text in ("ab", "abc", "abcd")] == ["a", "ab", "abc"]
    assert list(path.parent.iterdir()) == [path]


def test_an_extension_that_fails_leaves_the_file_and_nothing_else(path: Path) -> None:
    file = AlternatingFile(path)
    extend(file, "ab")

    def fail() -> None:
        with file.extending() as copy:
            copy.write_text("torn")
            raise OSError("no reason")

    with pytest.raises(RunFailed, match="cannot be written"):
        fail()
    assert path.read_text() == "ab"
    assert list(path.parent.iterdir()) == [path]
    assert extend(file, "abc") == "ab"


def test_what_a_kill_left_is_removed(path: Path) -> None:
    (path.parent / ".file.partial").write_text("torn")
    (path.parent / ".file.former.partial").write_text("a")
    assert extend(AlternatingFile(path), "ab") == "a"
