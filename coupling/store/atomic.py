"""Files that appear whole or not at all, also after a kill or on a full disk."""

from __future__ import annotations

import errno
import json
import math
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from coupling.ports import RunFailed


class UnreadableFile(RunFailed):
    """A file of a run that cannot be used: cut, damaged or of another version."""


# What h5py raises for a file that is cut, damaged or laid out in another way.
H5_ERRORS = (OSError, KeyError, RuntimeError, ValueError, TypeError, AttributeError)
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
    part = beside(path)
    try:
        with writing(path):
            yield part
            synced(part)
            part.replace(path)
    finally:
        discard(part)


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Turn what the system or HDF5 raise while ``path`` is written into ``RunFailed``."""
    try:
        yield
    except (OSError, RuntimeError) as error:
        if isinstance(error, RuntimeError) and "errno = " not in str(error):
            raise
        raise _failure(path, error) from error  # HDF5 fails with either


def beside(path: Path) -> Path:
    """Return the name, in the folder of ``path``, of a file that is not whole yet."""
    return path.with_name(f".{path.name}.partial")


def write_text(path: Path, text: str) -> None:
    """Write a small text file whole or not at all."""
    with replacing(path) as part:
        part.write_text(text, encoding="utf-8")


def write_json(path: Path, content: Any) -> None:
    """Write JSON whole or not at all; NaN and infinities become null, arrays become lists."""
    write_text(path, json.dumps(plain(content), indent=1, allow_nan=False) + "\n")


def read_json(
    path: Path, parts: Mapping[str, type | tuple[type, ...]], mend: str
) -> dict[str, Any]:
    """Read a JSON object that has at least ``parts``: keys and the types of their values.

    Raises ``UnreadableFile``, which ends with ``mend``.
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UnreadableFile(f"{path}: cannot be read: {error}. {mend}") from error
    if not isinstance(content, dict):
        raise UnreadableFile(f"{path}: holds no JSON object. {mend}")
    wrong = [k for k, kind in parts.items() if k not in content or not isinstance(content[k], kind)]
    if wrong:
        raise UnreadableFile(f"{path}: holds no proper {', '.join(wrong)}. {mend}")
    return content


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


def synced(path: Path) -> None:
    """Return when the file is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def discard(path: Path) -> None:
    """Remove the file, if it is there and can be removed."""
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
