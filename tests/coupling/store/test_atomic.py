"""Files that appear whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from coupling.ports import RunFailed
from coupling.store.atomic import replacing, write_json, write_text


def test_a_failure_half_way_keeps_the_old_file(tmp_path: Path) -> None:
    path = tmp_path / "a.txt"
    write_text(path, "old")

    def half() -> None:
        with replacing(path) as beside:
            beside.write_text("ne")
            raise KeyError("stop")

    with pytest.raises(KeyError):
        half()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match="nowhere"):
        write_text(tmp_path / "nowhere" / "a.txt", "x")


def test_json_has_no_nan_and_no_arrays(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    write_json(path, {"a": np.array([1.0, np.nan]), "b": np.int64(3), "c": (float("inf"), True)})
    assert json.loads(path.read_text()) == {"a": [1.0, None], "b": 3, "c": [None, True]}
