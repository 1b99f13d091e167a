"""Least thickness that keeps a limit: which to try next, and what the tried ones say.

No run is started here: a search is a function of what was tried, so it goes on after a stop.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

SCAN = 5  # thicknesses tried before any is halved: the ends and three between
WIDTH = 0.05  # of the bracket, relative: thicker over thinner less one
_DIGITS = 6  # of a thickness that is tried, far below the bracket's width


@dataclass(frozen=True, kw_only=True)
class Trial:
    """What a run of some thickness gave: the criterion's ``value``, or the ``failure``'s reason."""

    value: float | None = None
    failure: str | None = None


@dataclass(frozen=True, kw_only=True)
class Bracket:
    """Between which thicknesses [m] the criterion comes to be kept.

    ``too_thin`` is the thickest that was seen to miss the limit, ``enough`` the next thicker that
    keeps it, as all thicker ones do; None where there is none. ``thin_keepers``: thicknesses that
    keep it though a thicker one does not; ``rises``: pairs of neighbours, thinner and thicker, over
    which the value grows with the thickness.
    """

    too_thin: float | None
    enough: float | None
    thin_keepers: tuple[float, ...]
    rises: tuple[tuple[float, float], ...]

    @property
    def closed(self) -> bool:
        """Whether both ends are known and within ``WIDTH``."""
        known = self.too_thin is not None and self.enough is not None
        return known and _within(self.too_thin, self.enough)


def scan(least: float, largest: float) -> list[float]:
    """The thicknesses [m] that are tried first, geometric from ``least`` to ``largest``."""
    return [_rounded(one) for one in np.geomspace(least, largest, SCAN)]


def bracket_of(tried: Mapping[float, Trial], limit: float) -> Bracket:
    """What trials by thickness [m] say of a criterion that is kept below ``limit``."""
    known = _known(tried)
    too_thin, enough = None, None
    for thickness in sorted(known, reverse=True):
        if not known[thickness] < limit:
            too_thin = thickness
            break
        enough = thickness
    ordered = sorted(known)
    thinner = [one for one in ordered if too_thin is not None and one < too_thin]
    neighbours = itertools.pairwise(ordered)
    return Bracket(
        too_thin=too_thin,
        enough=enough,
        thin_keepers=tuple(one for one in thinner if known[one] < limit),
        rises=tuple(pair for pair in neighbours if known[pair[0]] < known[pair[1]]),
    )


def next_thicknesses(
    tried: Mapping[float, Trial], ends: tuple[float, float], limit: float
) -> list[float]:
    """Thicknesses [m] to try next, from the least to the largest of ``ends``; none at the end.

    First the ``scan``; then the geometric middle of the bracket until that is ``WIDTH`` wide, or a
    run in its middle has failed.
    """
    missing = [one for one in scan(*ends) if one not in tried]
    if missing:
        return missing
    found = bracket_of(tried, limit)
    if found.too_thin is None or found.enough is None or found.closed:
        return []
    middle = _rounded(math.sqrt(found.too_thin * found.enough))
    return [] if middle in tried else [middle]


def trials_left(tried: Mapping[float, Trial], ends: tuple[float, float], limit: float) -> int:
    """Return how many trials there will still be at the most, but for failures."""
    missing = sum(one not in tried for one in scan(*ends))
    found = bracket_of(tried, limit)
    if not missing and not next_thicknesses(tried, ends, limit):
        return 0
    ratio = (ends[1] / ends[0]) ** (1.0 / (SCAN - 1))
    if not missing and found.too_thin is not None and found.enough is not None:
        ratio = found.enough / found.too_thin
    halvings = math.log2(max(math.log(ratio) / math.log(1.0 + WIDTH), 1.0))
    return missing + math.ceil(halvings)


def _known(tried: Mapping[float, Trial]) -> dict[float, float]:
    return {t: trial.value for t, trial in tried.items() if trial.value is not None}


def _within(thinner: float | None, thicker: float | None) -> bool:
    assert thinner is not None
    assert thicker is not None
    return thicker <= (1.0 + WIDTH) * thinner


def _rounded(thickness: float) -> float:
    return float(f"{thickness:.{_DIGITS}g}")
