"""How fast this machine is, measured once and kept in the user's cache."""

from __future__ import annotations

import json
import platform
from contextlib import suppress
from functools import lru_cache
from pathlib import Path
from time import process_time

import numpy as np
from threadpoolctl import threadpool_limits

from coupling.foam.solver_cache import NoCache, cache_folder
from coupling.ports import RunFailed
from coupling.store.atomic import write_json

_KERNEL = 1  # version of ``_kernel``: what was kept of another one is not read
_REFERENCE = 0.015  # CPU time [s] of ``_kernel`` on the machine of the constants of ``cost``


@lru_cache(maxsize=1)
def slowness() -> float:
    """CPU time of this machine over that of the constants' one, for the same work.

    The least that was kept here, or else that is measured now, in a tenth of a second; nothing is
    written.
    """
    kept = _kept()
    return _measured() if kept is None else kept


def remember_speed() -> None:
    """Measure, and keep what was measured in the user's cache unless less is kept there.

    The least counts, since other programs only make a machine slower. What cannot be kept is not.
    """
    now, kept = _measured(), _kept()
    if kept is None or now < kept:
        with suppress(NoCache, OSError, RunFailed):
            path = _file()
            path.parent.mkdir(parents=True, exist_ok=True)
            write_json(path, {"slowness": now})


def _file() -> Path:
    """Raises ``NoCache``."""
    return cache_folder() / f"speed-{_KERNEL}-{platform.node() or 'machine'}.json"


def _kept() -> float | None:
    try:
        kept = float(json.loads(_file().read_text(encoding="utf-8"))["slowness"])
    except (NoCache, OSError, ValueError, KeyError, TypeError):
        return None
    return kept if 0.0 < kept < 1e3 else None


def _measured() -> float:
    """The work is the elimination of a sparse matrix, as most of a step is; least of three."""
    return min(_kernel() for _ in range(3)) / _REFERENCE


def _kernel() -> float:
    """CPU time [s] of factoring and solving with a matrix of 3600 rows, the Laplacian of a square.

    By block elimination with NumPy alone: SciPy's sparse solvers, by which the reference was
    measured first, take longer to import than all else that ``edt check`` does. In 180 pairs, on a
    machine with much else to do, this took 0.42 of their time, and 0.33 to 0.53 in eight of ten.
    """
    side = 60
    line = 4.001 * np.identity(side) - np.eye(side, k=1) - np.eye(side, k=-1)
    pivots, values = np.empty((side, side, side)), np.ones((side, side, 3))
    with threadpool_limits(1):
        start = process_time()
        pivots[0] = np.linalg.inv(line)
        for row in range(1, side):
            pivots[row] = np.linalg.inv(line - pivots[row - 1])
        for _ in range(10):
            for row in range(1, side):
                values[row] += pivots[row - 1] @ values[row - 1]
            values[-1] = pivots[-1] @ values[-1]
            for row in range(side - 2, -1, -1):
                values[row] = pivots[row] @ (values[row] + values[row + 1])
            values /= np.linalg.norm(values)
        return process_time() - start
