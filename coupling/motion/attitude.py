"""The attitude of a tank whose angular rates or angles are samples."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation, RotationSpline

from coupling.ports import Array, Ints


class RateAttitude:
    """Sampled ``rates`` (k, 3) [rad/s] in the tank's axes at ``time`` (k,) [s], linear in between.

    The tank stands upright at time 0. Between two samples h apart R' = R [omega] has the rotation
    vector a h + b h^2/2 + a x b h^3/12 of omega = a + b t, Magnus' expansion (Comm. Pure Appl.
    Math. 7, 1954): exact about an axis that stays, else off by O(h^5). Times outside the samples
    extrapolate.
    """

    sampled = True

    def __init__(self, time: Array, rates: Array) -> None:
        self._time, self._rates = time, rates
        self._slope = np.diff(rates, axis=0) / np.diff(time)[:, None]
        turns = _magnus(rates[:-1], self._slope, np.diff(time)[:, None])
        self._knots = _products(Rotation.from_rotvec(np.vstack([np.zeros(3), turns])))
        self._knots = self._at(0.0).inv() * self._knots

    def _at(self, time: Array | float) -> Rotation:
        piece = self._piece(time)
        since = np.asarray(time - self._time[piece])[..., None]
        turn = _magnus(self._rates[piece], self._slope[piece], since)
        return self._knots[piece] * Rotation.from_rotvec(turn)

    def _piece(self, time: Array | float) -> Ints:
        place = np.searchsorted(self._time, time, side="right") - 1
        return np.clip(place, 0, len(self._slope) - 1)

    def matrix(self, time: float) -> Array:
        """Integrated from time 0."""
        return np.asarray(self._at(time).as_matrix())

    def matrices(self, times: Array) -> Array:
        """R (k, 3, 3) at ``times`` (k,) [s]."""
        return np.asarray(self._at(times).as_matrix())

    def rate(self, time: float) -> Array:
        """Interpolated."""
        piece = self._piece(time)
        since = time - self._time[piece]
        return np.asarray(self._rates[piece] + since * self._slope[piece])

    def acceleration(self, time: float) -> Array:
        """Of the line between the samples."""
        return np.asarray(self._slope[self._piece(time)])


def _products(turns: Rotation) -> Rotation:
    """Return the products of the first, the first two, ... of ``turns``, doubling their spans."""
    found, span = turns, 1
    while span < len(turns):
        found = Rotation.concatenate([found[:span], found[:-span] * found[span:]])
        span *= 2
    return found


def _magnus(rate: Array, slope: Array, length: Array | float) -> Array:
    """Rotation vectors (..., 3) of ``rate`` + ``slope`` t over a ``length`` [s] from t = 0."""
    turned = length * rate + 0.5 * length**2 * slope
    return np.asarray(turned + length**3 / 12.0 * np.cross(rate, slope))


class AngleAttitude:
    """Sampled ``angles`` (k, 3) [rad], roll, pitch and yaw, at ``time`` (k,) [s].

    R = Rz(yaw) Ry(pitch) Rx(roll), right-handed about the tank's axes: yaw first, about z, then
    pitch about the new y, then roll about the new x (ISO 8855). Between them SciPy's spline of
    rotations, whose rate and acceleration are continuous.
    """

    sampled = True

    def __init__(self, time: Array, angles: Array) -> None:
        self._spline = RotationSpline(time, Rotation.from_euler("ZYX", angles[:, ::-1]))

    def matrix(self, time: float) -> Array:
        """Of the spline."""
        return np.asarray(self._spline(time).as_matrix())

    def matrices(self, times: Array) -> Array:
        """R (k, 3, 3) at ``times`` (k,) [s]."""
        return np.asarray(self._spline(times).as_matrix())

    def rate(self, time: float) -> Array:
        """Of the spline."""
        return np.asarray(self._spline(time, 1))

    def acceleration(self, time: float) -> Array:
        """Of the spline."""
        return np.asarray(self._spline(time, 2))
