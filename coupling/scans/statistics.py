"""The source's statistics of a scan, each with its standard error.

Vertical difference at each place, its mean and standard deviation; nearest distance, its mean,
least and largest (thesis, Tables 6 and 7), and its root mean square. Every point counts the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from coupling.ports import AnyArray, Array, Ints
from coupling.scans.pose import rates
from coupling.scans.sampling_error import largest_error, least_error, mean_error
from coupling.scans.sheet import ROUNDING, Heights, Matches, Sheet

# how each statistic is called in tables
NAMES = {
    "vertical_mean_m": "vertical difference, mean",
    "vertical_deviation_m": "vertical difference, standard deviation",
    "distance_mean_m": "nearest distance, mean",
    "distance_least_m": "nearest distance, least",
    "distance_largest_m": "nearest distance, largest",
    "distance_rms_m": "nearest distance, rms",
}
COUNTS = {
    "points": "points that have a counterpart",
    "beyond_rim": "points beyond the rim, left out",
    "vertical_points": "points with a vertical difference",
    "several_layers": "of these with several layers above or below",
    "too_steep": "points without, where the run's is steep",
    "no_layer": "points without, where the run has no layer",
}


@dataclass(frozen=True, kw_only=True)
class Figure:
    """A figure, and the standard error that the choice of points and their noise leave."""

    value: float
    standard_error: float


def written(figure: Mapping[str, float], scale: float) -> tuple[str, str]:
    """Return a figure and its error as text, to the error's second digit, 4 decimals at most.

    ``figure``: a ``Figure`` as a mapping; ``scale``: what both are multiplied by.
    """
    value, error = scale * figure["value"], scale * figure["standard_error"]
    decimals = 1 - int(np.floor(np.log10(error))) if error > 0.0 else 4
    decimals = min(max(decimals, 0), 4)
    return f"{value:.{decimals}f}", f"{error:.{decimals}f}"


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A scan held against the sheet in one pose.

    Attributes
    ----------
    matches, heights
        Of each point (p,).
    inside
        Whether (p,) a point has a counterpart, and counts.
    upright
        Whether (p,) its vertical difference counts, too.
    figures
        By the keys of ``NAMES``; without the vertical ones where no point has such a difference.
    counts
        Numbers of points by the keys of ``COUNTS``.
    """

    matches: Matches
    heights: Heights
    inside: AnyArray
    upright: AnyArray
    figures: dict[str, Figure]
    counts: dict[str, int]


def measure(
    sheet: Sheet, points: Array, blocks: Ints, size: float, influence: Array | None = None
) -> Measured:
    """Return the statistics of points against a sheet.

    Parameters
    ----------
    sheet
        The run's diaphragm.
    points
        The scan's points (p, 3) [m], moved.
    blocks
        Block (p,) of each, see ``blocks_of``.
    size
        The rim's radius [m].
    influence
        Of each point on the motion that moved them (p, 6) [m], see ``Alignment``; None where that
        does not hang on them.
    """
    matches, heights = sheet.match(points), sheet.heights(points)
    inside = ~matches.beyond
    # a wall's points are left out by the wall itself, or noise would leave those on one side of it
    steep = heights.steep | sheet.is_steep(matches.triangle)
    upright = inside & np.isfinite(heights.difference) & ~steep
    found = _Means(blocks, points, size, influence)
    figures: dict[str, Figure] = {}
    if upright.sum() > 1:
        height = np.where(upright, heights.difference, 0.0)
        figures["vertical_mean_m"] = found.mean(height, heights.slope, upright)
        off = np.where(upright, height - figures["vertical_mean_m"].value, 0.0)
        figures["vertical_deviation_m"] = found.root(off, heights.slope, upright)
    distance = np.abs(matches.distance)
    ways = matches.way * np.sign(matches.distance)[:, None]
    figures["distance_mean_m"] = found.mean(distance, ways, inside)
    for name, value, error in (
        ("least", distance[inside].min(), least_error),
        ("largest", distance[inside].max(), largest_error),
    ):
        spread = error(distance[inside], blocks[inside])
        figures[f"distance_{name}_m"] = Figure(value=float(value), standard_error=spread)
    figures["distance_rms_m"] = found.root(distance, ways, inside)
    return Measured(
        matches=matches,
        heights=heights,
        inside=inside,
        upright=upright,
        figures=figures,
        counts={
            "points": int(inside.sum()),
            "beyond_rim": int(matches.beyond.sum()),
            "vertical_points": int(upright.sum()),
            "several_layers": int((upright & heights.several).sum()),
            "too_steep": int((inside & steep).sum()),
            "no_layer": int((inside & heights.none & ~steep).sum()),
        },
    )


class _Means:
    """Means over points and their errors, those of the points' common motion included."""

    def __init__(self, blocks: Ints, points: Array, size: float, influence: Array | None) -> None:
        self._blocks, self._points, self._size = blocks, points, size
        self._influence = influence

    def mean(self, values: Array, gradient: Array, used: AnyArray) -> Figure:
        """Of ``values`` (p,) that grow by ``gradient`` (p, 3), over the ``used`` points."""
        value = float(values[used].mean())
        error = mean_error(self._each(values - value, gradient, used), self._blocks)
        return Figure(value=value, standard_error=error)

    def root(self, values: Array, gradient: Array, used: AnyArray) -> Figure:
        """Root mean square; the delta method's error."""
        square = self.mean(values**2, 2.0 * values[:, None] * gradient, used)
        value = float(np.sqrt(square.value))
        error = square.standard_error / (2.0 * value) if value > 0.0 else 0.0
        return Figure(value=value, standard_error=error)

    def _each(self, off: Array, gradient: Array, used: AnyArray) -> Array:
        """Influence (p,) of each point on the mean from which values are ``off`` (p,)."""
        share = len(used) / used.sum()
        each: Array = np.where(used, off, 0.0) * share
        if self._influence is not None:
            grows = rates(self._points[used], gradient[used], self._size).mean(axis=0)
            each = each + self._influence @ grows
        return each


def explained(before: Measured, after: Measured, blocks: Ints, size: float) -> Figure:
    """Return the share of the mean square distance that alignment takes away.

    One less the ratio of the squares of both ``distance_rms_m``. The motion is where the second is
    least, so that its own error does not count. ``blocks`` (p,); ``size``: the rim's radius [m].
    Of a scan that lies on the run to rounding nothing is left to explain: 0.
    """
    squares, each = [], []
    for one in (before, after):
        square = np.where(one.inside, one.matches.distance**2, 0.0)
        mean = float(square[one.inside].mean())
        squares.append(mean)
        each.append(np.where(one.inside, square - mean, 0.0) * len(square) / one.inside.sum())
    if squares[0] <= (ROUNDING * size) ** 2:
        return Figure(value=0.0, standard_error=0.0)
    ratio = squares[1] / squares[0]
    error = mean_error((each[1] - ratio * each[0]) / squares[0], blocks)
    return Figure(value=1.0 - ratio, standard_error=error)
