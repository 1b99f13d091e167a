"""Errors of figures of a scan: by how much they would differ had other points been scanned.

Residuals of neighbouring points go together: the scanner's own errors do, and where a shape lies
elsewhere it does so over an area. So the points are put into blocks, and the blocks are what is
taken as independent. What changes over the surface as a whole, as noise does with the slope, is no
sampling error: blocks are compared with their neighbours alone (successive differences; Wolter,
Introduction to Variance Estimation, 2nd ed., section 8.2). Of blocks of three sizes the largest
error is taken, since it grows with the size as long as residuals reach from block to block
(Flyvbjerg and Petersen, J. Chemical Physics 91, 1989).

Of independent residuals a mean's error comes out 10 % too large for that, the standard deviation of
vertical differences, whose noise changes with the slope within blocks, up to twice too large.
Residuals that go together over 0.1, 0.2 and 0.45 radii leave it 5, 30 and 80 % too small.
"""

from __future__ import annotations

import numpy as np

from coupling.ports import Array, Ints

MOST = 128  # blocks, 64 pairs of neighbours, each 0.16 radii wide: errors known to 9 %
_LEAST_POINTS = 10  # a block
_SIZES, _LEAST_BLOCKS = 3, 32  # sizes of blocks, each of two of the former, and the fewest of them


def blocks_of(points: Array) -> Ints:
    """Return the block (p,) of each point: compact parts of nearly equal number.

    ``points`` (p, 3). They are halved across their longest extent, again and again, into 128
    blocks, or fewer where these would have less than 10 points. Blocks 2k and 2k + 1 are halves.
    """
    groups = [np.arange(len(points))]
    while len(groups) < MOST and len(points) >= 2 * _LEAST_POINTS * len(groups):
        halved = []
        for group in groups:
            along = points[group, int(np.argmax(np.ptp(points[group], axis=0)))]
            half = len(group) // 2
            order = np.argpartition(along, half)
            halved += [group[order[:half]], group[order[half:]]]
        groups = halved
    found = np.empty(len(points), dtype=np.int64)
    for number, group in enumerate(groups):
        found[group] = number
    return found


def mean_error(influence: Array, blocks: Ints) -> float:
    """Return the standard error of a figure from the ``influence`` (p,) of each point on it.

    The figure is, to first order, the mean of its influences, which sum to zero. ``blocks`` (p,):
    pairs of neighbours, and so are pairs of these.
    """
    sums = np.bincount(blocks, influence, minlength=int(blocks.max()) + 1)
    scatter = [float(np.linalg.norm(sums[0::2] - sums[1::2]))]
    while len(scatter) < _SIZES and len(sums) >= 2 * _LEAST_BLOCKS:
        sums = sums[0::2] + sums[1::2]
        scatter.append(float(np.linalg.norm(sums[0::2] - sums[1::2])))
    return max(scatter) / len(influence)


def largest_error(values: Array, blocks: Ints) -> float:
    """Return the standard error of the largest of ``values`` (p,) >= 0 of as many points.

    The squares of a normal error have an exponential tail, so the largest of each block follows
    Gumbel's law, and so does the largest of all, with the same scatter. ``blocks`` (p,).
    """
    squares = np.array([np.max(values[blocks == one] ** 2) for one in np.unique(blocks)])
    largest = float(values.max())
    return float(np.std(squares, ddof=1)) / (2.0 * largest) if largest > 0.0 else 0.0


def least_error(values: Array, blocks: Ints) -> float:
    """Return the standard error of the least of ``values`` (p,) >= 0 of as many points.

    The least of each block follows Weibull's law of a shape k, by its coefficient of variation
    (k = CV^-1.086; Justus et al., J. Applied Meteorology 17, 1978), and the least of all n blocks
    the same law, smaller by n^(-1/k). Near zero k is 1. ``blocks`` (p,).
    """
    least = np.array([values[blocks == one].min() for one in np.unique(blocks)])
    scatter, mean = float(np.std(least, ddof=1)), float(least.mean())
    if scatter == 0.0:
        return 0.0
    shape = max(1.0, (scatter / mean) ** -1.086)
    return scatter * float(len(least) ** (-1.0 / shape))
