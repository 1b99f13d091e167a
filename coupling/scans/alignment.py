"""Alignment of a scan: about the tank's axis by any angle, and by a small rigid motion.

Gauss and Newton's method on the distances of the points from the triangles (the point-to-plane ICP
of Chen and Medioni, Image and Vision Computing 10, 1992, with the true nearest points), in the
motions that the surface determines; from azimuths all around, since folds repeat themselves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.ports import Array, Ints
from coupling.scans.pose import Pose, determined, names_known, rates
from coupling.scans.sampling_error import blocks_of, mean_error
from coupling.scans.sheet import Sheet

SPACING = 5.0  # degrees between azimuths to start from: up to 36 folds round the rim differ
# Points that a motion is fitted to, and the iterations, in turn: from all azimuths, from the best
# of these, from those as good as the best. 20,000 leave of a scanner's noise a hundredth and less.
_FEW, _SOME, _MANY = (300, 4), (1500, 10), (20_000, 100)
_BEST = 4  # azimuths that are looked at with more points
_SMALL = 1e-6  # of the rim's radius: a motion that ends the iteration
_SAME = np.radians(1.0)  # azimuths that have come to one minimum
_SIGNIFICANT = 2.0  # standard errors by which a fit has to be better


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """How a scan is moved onto the sheet.

    Attributes
    ----------
    pose
        The motion.
    basis
        The motions (6, k) that the surface determines, see ``determined``.
    influence
        Of each point on the motion (p, 6) [m]: to first order the motion is in error by their mean.
    as_good
        Other azimuths [rad] that fit no worse than the error of the fit, of larger turns.
    left
        How far [m] the last iteration still moved: the norm of ``rates``' motion.
    """

    pose: Pose
    basis: Array
    influence: Array
    as_good: tuple[float, ...]
    left: float


def align(sheet: Sheet, points: Array, size: float) -> Alignment:
    """Return the motion that takes a scan's ``points`` (p, 3) [m] onto the ``sheet``.

    Of azimuths that fit equally well within the error of the fit and of the triangles, the one with
    the least turn. ``size``: the rim's radius [m].
    """
    order = np.random.default_rng(0).permutation(len(points))
    few, some, many = (np.sort(order[:most]) for most, _ in (_FEW, _SOME, _MANY))
    matches = sheet.match(points[some])
    basis, facets = determined(sheet, matches, points[some], size), sheet.facet_error(matches)
    poses = [Pose.turned(0.0)]
    if names_known(basis)["azimuth"]:
        around = [Pose.turned(float(one)) for one in np.radians(np.arange(0.0, 360.0, SPACING))]
        found = _fits(sheet, points[few], around, basis, size, _FEW[1])
        found = _fits(sheet, points[some], _distinct(found), basis, size, _SOME[1])
        poses = [fit.pose for fit in _as_good(found, blocks_of(points[some]), facets)]
    fits = _fits(sheet, points[many], poses, basis, size, _MANY[1])
    best, *others = _one_each(_as_good(fits, blocks_of(points[many]), facets))
    influence = np.zeros((len(points), 6))
    influence[many] = _influence(sheet, best.pose.moved(points[many]), basis, size)
    return Alignment(
        pose=best.pose,
        basis=basis,
        influence=influence * (len(points) / len(many)),
        as_good=tuple(one.pose.azimuth for one in others),
        left=best.left,
    )


@dataclass(frozen=True, kw_only=True)
class _Fit:
    """A pose, the squares (p,) [m^2] of the distances that it leaves, its last motion [m]."""

    pose: Pose
    squares: Array
    left: float


def _fits(
    sheet: Sheet, points: Array, starts: list[Pose], basis: Array, size: float, most: int
) -> list[_Fit]:
    """Fit to ``points`` (p, 3) from each of ``starts``, with ``most`` iterations."""
    fits = []
    for start in starts:
        pose, left = _fit(sheet, points, start, basis, size, most)
        squares = sheet.match(pose.moved(points)).distance ** 2
        fits.append(_Fit(pose=pose, squares=squares, left=left))
    return fits


def _distinct(fits: list[_Fit]) -> list[Pose]:
    """The pose of the first of ``fits``, and those of the best of the others, each minimum once."""
    ranked = sorted(fits[1:], key=lambda one: float(one.squares.mean()))
    return [fit.pose for fit in _one_each([fits[0], *ranked])[: _BEST + 1]]


def _one_each(fits: list[_Fit]) -> list[_Fit]:
    """The first of ``fits`` that have come to one azimuth."""
    found: list[_Fit] = []
    for fit in fits:
        if not any(_same(fit.pose, one.pose) for one in found):
            found.append(fit)
    return found


def _fit(
    sheet: Sheet, points: Array, start: Pose, basis: Array, size: float, most: int
) -> tuple[Pose, float]:
    """The pose at which the mean square distance is least near ``start``, and its last motion."""
    pose, left = start, np.inf
    for _ in range(most):
        moved = pose.moved(points)
        matches = sheet.match(moved)
        inside = ~matches.beyond
        slopes = rates(moved[inside], matches.way[inside], size) @ basis
        motion = basis @ np.linalg.lstsq(slopes, -matches.distance[inside], rcond=None)[0]
        pose, left = pose.then(motion, size), float(np.linalg.norm(motion))
        if left < _SMALL * size:
            break
    return pose, left


def _influence(sheet: Sheet, moved: Array, basis: Array, size: float) -> Array:
    """Of each point (p, 6) [m] on the motion that was fitted to all of them."""
    matches = sheet.match(moved)
    inside = ~matches.beyond
    slopes = rates(moved, matches.way, size) @ basis
    slopes[~inside] = 0.0
    normal = slopes.T @ slopes / len(moved)
    found: Array = -np.linalg.solve(normal, (slopes * matches.distance[:, None]).T).T @ basis.T
    return found


def _as_good(fits: list[_Fit], blocks: Ints, facets: float) -> list[_Fit]:
    """Those of ``fits`` that are as good as the best within the error, the least turn first.

    A smooth scan lies as much off the triangles as these off the smooth surface, ``facets`` [m]
    rms: azimuths that differ by less than its square differ by the grid alone.
    """
    best = min(fits, key=lambda one: float(one.squares.mean()))
    found = []
    for fit in fits:
        worse = fit.squares - best.squares
        error = mean_error(worse - worse.mean(), blocks)
        if worse.mean() <= _SIGNIFICANT * error + facets**2:
            found.append(fit)
    return sorted(found, key=lambda one: abs(one.pose.azimuth))


def _same(one: Pose, other: Pose) -> bool:
    """Whether two poses have the same azimuth."""
    apart = (one.azimuth - other.azimuth + np.pi) % (2.0 * np.pi) - np.pi
    return bool(abs(apart) < _SAME)
