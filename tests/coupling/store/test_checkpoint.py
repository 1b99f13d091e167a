"""Checkpoints: bit for bit, and refused when damaged."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from coupling.ports import RunFailed
from coupling.store.checkpoint import load_checkpoint, save_checkpoint

PARTS = {
    "structure": {
        "position": np.random.default_rng(1).standard_normal((5, 3)),
        "special": np.array([np.nan, -0.0, np.inf, 5e-324, 1.0 + 2**-52]),
        "fixed": np.array([True, False]),
    },
    "fluid": {
        "case.tar": np.frombuffer(b"\x00\xffraw", dtype=np.uint8),
        "U/old time": np.arange(6, dtype=np.float32).reshape(2, 3),
        "empty": np.zeros((0, 3)),
        "scalar": np.array(3, dtype=np.int32),
    },
    "scheme": {},
}


def test_arrays_come_back_bit_for_bit(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.h5"
    attributes = {"time": 0.1 + 0.2, "step": np.int64(7), "statistics": {"by": {"fluid": 1e-300}}}
    save_checkpoint(path, PARTS, attributes)
    parts, read = load_checkpoint(path)
    assert read == {"time": 0.1 + 0.2, "step": 7, "statistics": {"by": {"fluid": 1e-300}}}
    assert {part: set(items) for part, items in parts.items()} == {
        part: set(items) for part, items in PARTS.items()
    }
    for part, items in PARTS.items():
        for name, values in items.items():
            back = parts[part][name]
            assert (back.dtype, back.shape) == (values.dtype, values.shape)
            assert back.tobytes() == values.tobytes()


def test_a_missing_checkpoint_names_the_mend(tmp_path: Path) -> None:
    with pytest.raises(RunFailed, match="edt run"):
        load_checkpoint(tmp_path / "checkpoint.h5")


@pytest.mark.parametrize("cut", [0, 10, 600, -1])
def test_a_torn_checkpoint_is_refused(tmp_path: Path, cut: int) -> None:
    path = tmp_path / "checkpoint.h5"
    save_checkpoint(path, PARTS, {})
    path.write_bytes(path.read_bytes()[:cut])
    with pytest.raises(RunFailed, match="damaged"):
        load_checkpoint(path)


def test_one_flipped_bit_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.h5"
    save_checkpoint(path, PARTS, {})
    raw = bytearray(path.read_bytes())
    raw[raw.index(PARTS["structure"]["position"].tobytes()) + 5] ^= 1
    path.write_bytes(raw)
    with pytest.raises(RunFailed, match="checksum"):
        load_checkpoint(path)


def test_a_failed_save_keeps_the_former_one(tmp_path: Path) -> None:
    path = tmp_path / "checkpoint.h5"
    save_checkpoint(path, PARTS, {"time": 1.0})
    with pytest.raises(TypeError):
        save_checkpoint(path, {"a": {"b": np.array([object()])}}, {})
    assert load_checkpoint(path)[1] == {"time": 1.0}
    assert [item.name for item in tmp_path.iterdir()] == ["checkpoint.h5"]
