"""Files that appear whole or not at all, also after a kill or on a full disk."""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from coupling.ports import RunFailed

_FULL = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A name beside ``path`` to write to; on leaving, what stands there becomes ``path``.

    The new file is on the disk (fsync) before it takes the name. When anything fails, ``path``
    stays as it was and the new file is removed.

    Raises
    ------
    RunFailed
        The file cannot be written (disk full, no permission ...).
    """
    beside = path.with_name(f".{path.name}.partial")
    try:
        yield beside
        _sync(beside)
        beside.replace(path)
    except (OSError, RuntimeError) as error:
        if isinstance(error, RuntimeError) and "errno = " not in str(error):
            raise
        raise _failure(path, error) from error  # HDF5 fails with either
    finally:
        _discard(beside)


def write_text(path: Path, text: str) -> None:
    """Write a small text file whole or not at all."""
    with replacing(path) as beside:
        beside.write_text(text, encoding="utf-8")


def write_json(path: Path, content: Any) -> None:
    """Write JSON whole or not at all; NaN and infinities become null, arrays become lists."""
    write_text(path, json.dumps(plain(content), indent=1, allow_nan=False) + "\n")


def plain(value: Any) -> Any:
    """``value`` in what JSON can say: no arrays, no NumPy scalars, null for what is not finite."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value


def _sync(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _discard(path: Path) -> None:
    try:
        path.unlink(missing_ok=True)
    except OSError:  # the first error says more
        return


def _failure(path: Path, error: OSError | RuntimeError) -> RunFailed:
    # HDF5's own errors may carry their number in the text only
    text = str(error)
    full = getattr(error, "errno", None) in _FULL or any(f"errno = {n}," in text for n in _FULL)
    if not full:
        return RunFailed(f"{path}: cannot be written: {text}. Give a folder that can be written.")
    try:
        free = f"{shutil.disk_usage(path.parent).free / 1e6:.1f} MB free"
    except OSError:
        free = "free space unknown"
    return RunFailed(
        f"{path}: the disk is full, or the file may not grow further ({free}). "
        "What was written before is kept. Make room, then `edt resume` the folder; "
        "a larger time.output_every needs less."
    )
