"""A growing file in two copies: the one that has the name is whole and is never written to."""

from __future__ import annotations

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from coupling.store.atomic import beside, discard, synced, writing


class AlternatingFile:
    """A file that grows at its end, and is whole for its readers at every moment.

    It has a second copy under a hidden name. An extension goes into the second copy, which then
    takes the name, while the file that had it becomes the second copy. That one lacks the last
    extension: the next one has to make up for it. So every byte is written twice, however often
    the file is extended, and disk space is taken twice until ``close``.

    A copy that a program still reads is left to it, and a new one is made; so it is where the file
    system has no hard links or no leases. What a killed process left of a second copy is removed.
    """

    def __init__(self, path: Path) -> None:
        self._path, self._second = path, beside(path)
        self._former = path.with_name(f".{path.name}.former.partial")
        self.close()

    @contextmanager
    def extending(self) -> Iterator[Path]:
        """Yield the copy to extend; on leaving without an error it becomes the file.

        It holds what the file holds, or lacks the last extension.

        Raises
        ------
        RunFailed
            The disk is full or cannot be written; the file stays as it was.
        """
        kept = False
        try:
            with writing(self._path):
                if not _unread(self._second):
                    discard(self._second)
                    shutil.copyfile(self._path, self._second)
                yield self._second
                synced(self._second)
                kept = self._exchange()
        finally:
            if not kept:
                self.close()

    def close(self) -> None:
        """Remove the second copy."""
        discard(self._second)
        discard(self._former)

    def _exchange(self) -> bool:
        """Give the second copy the name; whether the other is kept in its place."""
        try:
            os.link(self._path, self._former)
        except OSError:  # a file system without hard links
            self._second.replace(self._path)
            return False
        self._second.replace(self._path)
        self._former.replace(self._second)
        return True


def _unread(path: Path) -> bool:
    """Whether the file is there and no process has it open.

    The kernel grants a lease for writing (``fcntl(2)``) only where no other descriptor is open.
    """
    try:
        descriptor = os.open(path, os.O_RDWR)
    except OSError:
        return False
    try:
        fcntl.fcntl(descriptor, fcntl.F_SETLEASE, fcntl.F_WRLCK)
        fcntl.fcntl(descriptor, fcntl.F_SETLEASE, fcntl.F_UNLCK)
    except OSError:
        return False
    finally:
        os.close(descriptor)
    return True
