"""Where compiled functions are kept on disk, and how a damaged file is recognised.

Numba unpickles what it finds and runs the machine code in it: an emptied file ends the program,
and one with other bytes may do anything. Here every file starts with the digest of the rest; one
that does not match is as good as none, and the function is compiled again.
"""

from __future__ import annotations

import logging
import pickle
from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from numba.core import caching
from numba.core.serialize import dumps

_DIGEST = 32  # bytes
_log = logging.getLogger(__name__)


class _UserWide(caching.UserWideCacheLocator):
    """The user's cache folder, where there is a home: without one numba makes a folder ``~``."""

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> Any:
        """Return numba's locator, None where there is no home."""
        try:
            Path("~").expanduser()
        except RuntimeError:
            return None
        return super().from_function(py_func, py_file)


class _Results(caching.CompileResultCacheImpl):
    def __init__(self, py_func: Callable[..., Any]) -> None:
        self._locator_classes = [
            caching.UserProvidedCacheLocator, caching.InTreeCacheLocator, _UserWide,
        ]  # fmt: skip
        super().__init__(py_func)

    def get_filename_base(self, fullname: str, abiflags: str) -> str:
        """Return numba's name, marked as that of a file with a digest."""
        return f"digest-{super().get_filename_base(fullname, abiflags)}"


class _Files(caching.IndexDataCacheFile):
    """Numba's two kinds of files, each behind its digest."""

    def save(self, key: Any, data: Any) -> None:
        """Save as numba does; a disk that cannot be written is reported once, and ends nothing."""
        try:
            super().save(key, data)
        except OSError as error:
            _say_once(f"{error.filename or self._cache_path}: {error.strerror}")

    def _load_index(self) -> dict[Any, str]:
        content = self._read(Path(self._index_path))
        if content is None:
            return {}
        version, stamp, overloads = pickle.loads(content)
        fresh = (version, stamp) == (self._version, self._source_stamp)
        return dict(overloads) if fresh else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, dumps((self._version, self._source_stamp, overloads)))

    def _load_data(self, name: str) -> Any:
        content = self._read(Path(self._data_path(name)))
        if content is None:
            raise FileNotFoundError(name)  # as numba has it where the index names a file too many
        return pickle.loads(content)

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), dumps(data))

    def _write(self, path: str, content: bytes) -> None:
        with self._open_for_write(path) as file:
            file.write(sha256(content).digest() + content)

    def _read(self, path: Path) -> bytes | None:
        """What was written; None where there is nothing, or something else."""
        try:
            content = path.read_bytes()
        except FileNotFoundError:
            return None
        except OSError as error:
            _log.warning("%s: %s. It is compiled again.", path, error.strerror)
            return None
        digest, content = content[:_DIGEST], content[_DIGEST:]
        if digest != sha256(content).digest():
            _log.warning("%s: damaged. It is compiled again.", path)
            return None
        return content


class CheckedCache(caching.FunctionCache):
    """A function's compiled forms on disk."""

    _impl_class = _Results

    def __init__(self, py_func: Callable[..., Any]) -> None:
        super().__init__(py_func)
        files = self._cache_file
        self._cache_file = _Files(files._cache_path, self._impl.filename_base, files._source_stamp)


def cache_of(function: Callable[..., Any]) -> caching._Cache:
    """Return the cache of ``function``; one that keeps nothing where no folder can be written."""
    try:
        return CheckedCache(function)
    except RuntimeError as error:  # numba found no folder, or not the finder it was to use
        _say_once(str(error).partition(" for file")[0].partition(" function")[0])
        return caching.NullCache()


@cache
def _say_once(reason: str) -> None:
    _log.warning(
        "Compiled functions are not kept (%s), so that every start compiles them anew: "
        "set NUMBA_CACHE_DIR to a folder that can be written.",
        reason,
    )
