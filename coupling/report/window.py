"""Part of a run that is shown: the one asked for, or of a record the one that moves most."""

from __future__ import annotations

import tomllib

import numpy as np

from coupling.motion import MOTIONS
from coupling.ports import Array, Ints
from coupling.store.results import Results

Window = tuple[float, float]  # first and last time [s]
_LENGTH = 1.0  # s, about a period of slosh in tanks of 0.4 to 1 m


class WindowError(ValueError):
    """A window that holds nothing of a run; the message has the mend."""


def by_record(results: Results) -> bool:
    """Whether the run's tank follows a record, of which no period can be shown."""
    motion = tomllib.loads(results.scene_toml).get("motion") or {}
    return motion.get("kind") in MOTIONS and MOTIONS[motion["kind"]].reads_file


def drawn(results: Results) -> bool:
    """Whether liquid is drawn from the run's tank, of which the whole run is shown."""
    supply = tomllib.loads(results.scene_toml).get("supply") or {}
    return "end_fill_fraction" in supply


def liveliest(results: Results) -> Window | None:
    """The second round the instant at which the CG is farthest from its mean; None of a sine.

    The whole run where liquid is drawn.
    """
    if len(results.time) and drawn(results):
        return float(results.time[0]), float(results.time[-1])
    if not len(results.time) or not by_record(results):
        return None
    away = np.linalg.norm(results.liquid_cg - results.liquid_cg.mean(axis=0), axis=1)
    first, last = float(results.time[0]), float(results.time[-1])
    start = min(float(results.time[away.argmax()]) - 0.5 * _LENGTH, last - _LENGTH)
    start = max(start, first)
    return start, min(start + _LENGTH, last)


def window_of(results: Results, start: float | None, end: float | None) -> Window | None:
    """From ``start`` to ``end`` [s], the run's own where one is None; None without either.

    Raises ``WindowError`` where the run has no instant, or only one, in it.
    """
    if start is None and end is None:
        return None
    if not len(results.time):
        raise WindowError("--from, --to: the run has no instant yet. Try again later.")
    first, last = float(results.time[0]), float(results.time[-1])
    window = first if start is None else start, last if end is None else end
    if window[0] >= window[1]:
        raise WindowError(
            f"--from: must lie before --to, got {window[0]:g} and {window[1]:g} s. Give two times "
            f"between {first:g} and {last:g} s."
        )
    count = len(rows_within(results.time, window))
    if count < 2:
        raise WindowError(
            f"--from, --to: {window[0]:g} to {window[1]:g} s holds {count} of the run's instants, "
            f"which lie between {first:g} and {last:g} s, {_apart(results.time):.3g} s apart. "
            "Give a window that holds two, or run with a smaller time.output_every."
        )
    return window


def rows_within(time: Array, window: Window) -> Ints:
    """Rows of the instants ``time`` (T,) [s] within ``window``, to a millionth of the last one."""
    slack = 1e-6 * float(time[-1])
    return np.flatnonzero((time >= window[0] - slack) & (time <= window[1] + slack))


def _apart(time: Array) -> float:
    return float(np.median(np.diff(time))) if len(time) > 1 else 0.0
