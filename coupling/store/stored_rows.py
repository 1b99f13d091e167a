"""Arrays over time that stay on the disk: what is asked for is read, row by row."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import h5py
import numpy as np

from coupling.ports import Array

BLOCK_BYTES = 2**20  # of all series together: small in memory, and many chunks of a file


class StoredRows:
    """A dataset (T, ...) that is read where it is indexed, and whole by ``numpy.asarray``.

    The file stays open as long as this is kept.
    """

    def __init__(self, dataset: h5py.Dataset) -> None:
        self._dataset = dataset
        self.shape: tuple[int, ...] = dataset.shape
        self.dtype: np.dtype[Any] = dataset.dtype

    def __len__(self) -> int:
        return self.shape[0]

    def __getitem__(self, key: Any) -> Array:
        """Rows by number, slice or list in any order; further indices as h5py has them."""
        if isinstance(key, list | np.ndarray):
            rows, place = np.unique(np.asarray(key, dtype=np.int64), return_inverse=True)
            return np.asarray(self._dataset[rows])[place]
        return np.asarray(self._dataset[key])

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Array:
        """Return all rows; always a copy of the file's."""
        del copy
        return np.asarray(self._dataset[()], dtype=dtype)


def blocks(*series: Array) -> Iterator[tuple[Array, ...]]:
    """Yield arrays or ``StoredRows`` of T rows each in blocks of some rows, one after the other.

    Each block is a tuple of arrays (k, ...), one a series, of the same rows; together they take
    ``BLOCK_BYTES`` or a row.
    """
    width = sum(one.dtype.itemsize * int(np.prod(one.shape[1:], dtype=int)) for one in series)
    count = max(1, BLOCK_BYTES // max(1, width))
    for first in range(0, len(series[0]), count):
        yield tuple(one[first : first + count] for one in series)
