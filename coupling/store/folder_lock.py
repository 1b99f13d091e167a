"""One process at a time writes into a folder: an advisory lock that ends with its process."""

from __future__ import annotations

import errno
import fcntl
import json
import logging
import os
import socket
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

LOCK_FILE = ".lock"
_UNSUPPORTED = {errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP}
_log = logging.getLogger(__name__)


class FolderError(Exception):
    """A folder that cannot be used; the message says why and the mend."""


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Hold the lock of ``folder``, which is created if need be.

    The kernel drops the lock when the process ends, however it ends; programs started meanwhile
    do not inherit it. What a killed process leaves is a file without a lock, which is taken over.
    A file system without locks is warned of.

    Raises
    ------
    FolderError
        Another process holds it, or ``folder`` cannot be written.
    """
    path = folder / LOCK_FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
        descriptor = _locked(path)
    except OSError as error:
        raise FolderError(
            f"{folder}: cannot be written: {error.strerror}. Give another folder with -o."
        ) from error
    try:
        with suppress(OSError):  # a full disk: the lock holds all the same
            os.ftruncate(descriptor, 0)
            os.write(descriptor, _owner().encode())
        yield
    finally:
        with suppress(OSError):
            path.unlink(missing_ok=True)
        os.close(descriptor)


def check_not_held(folder: Path) -> None:
    """Raise ``FolderError`` where a process holds the lock of a folder within ``folder``."""
    for path in folder.rglob(LOCK_FILE):
        if path.parent != folder:
            descriptor = os.open(path, os.O_RDWR)
            try:
                _take(descriptor, path)
            finally:
                os.close(descriptor)


def _locked(path: Path) -> int:
    """Descriptor of the locked file ``path``, created if need be."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            _take(descriptor, path)
            if _names(path, descriptor):
                return descriptor
        except BaseException:
            os.close(descriptor)
            raise
        os.close(descriptor)  # its former holder removed it between the two


def _names(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False


def _take(descriptor: int, path: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        raise FolderError(_refusal(path)) from error
    except OSError as error:
        if error.errno not in _UNSUPPORTED:
            raise
        _log.warning(
            "%s: the file system knows no locks: do not start two runs in this folder.",
            path.parent,
        )


def _owner() -> str:
    now = time.strftime("%Y-%m-%d %H:%M:%S")
    return json.dumps({"pid": os.getpid(), "host": socket.gethostname(), "since": now})


def _refusal(path: Path) -> str:
    try:
        owner = json.loads(path.read_text(encoding="utf-8"))
        who = f"process {owner['pid']} on {owner['host']} since {owner['since']}"
    except (OSError, ValueError, KeyError, TypeError):  # being written, or a full disk
        who = "another process"
    return (
        f"{path.parent}: {who} computes here. Wait for its end or end it, then try again; "
        "or give another folder with -o."
    )
