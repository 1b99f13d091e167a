"""Fit of modal models to runs: output error, weighed by the runs' own error.

The residual is the transform of force less the model's force in time, at the lines of a band, over
the spread between the runs (Ljung, System Identification, 2nd ed. 1999, sections 7.2 and 10.4).
Since the model is solved in time from rest, a run need be neither steady nor whole periods long.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from coupling.mechanical.apparent_mass import Band, spread_of
from coupling.mechanical.modal_model import Complex, ModalModel, unit_force
from coupling.mechanical.recording import Recording
from coupling.ports import Array

MOST_MODES = 3
WORTH = 0.1  # by which a mode more has to lower the error of runs left out
_STARTS = 60  # frequencies among which a further mode begins
_DAMPING = 0.02  # with which it begins
_MOST_DAMPING = 0.7
_QUIET = 1e-6  # of a run's largest line: what counts as no spread at all


@dataclass(frozen=True, kw_only=True)
class Fit:
    """``model``, and the covariance of its masses, omegas and dampings (3 K, 3 K), in their units.

    ``heights_error`` (K + 1,) [m]: standard errors of its heights.
    """

    model: ModalModel
    covariance: Array
    heights_error: Array

    @property
    def modes(self) -> int:
        """Number of modes."""
        return len(self.model.masses)


class Problem:
    """Runs in a band, and the weight of every line; what is fitted is (m_k, w_k, z_k)."""

    def __init__(self, recordings: list[Recording], total: float, band: Band) -> None:
        self.recordings, self.total, self.band = recordings, total, band
        self._rigid = [
            band.transform(one, one.force + total * one.acceleration) for one in recordings
        ]
        self._given = [band.transform(one, one.acceleration) for one in recordings]
        self._spread = [np.ones(len(lines)) for lines in self._rigid]
        self.largest = max(float(np.abs(lines).max()) for lines in self._rigid)

    def without(self, index: int) -> Problem:
        """The same problem, weights kept, with the run of that ``index`` left out."""
        kept = [place for place in range(len(self.recordings)) if place != index]
        fewer = Problem([self.recordings[place] for place in kept], self.total, self.band)
        fewer._spread = [self._spread[place] for place in kept]
        return fewer

    def column(self, index: int, omega: float, damping: float) -> Complex:
        """Complex lines of what 1 kg of a mode in place of fixed mass adds to a run's force."""
        one = self.recordings[index]
        force = unit_force(omega, damping, one.acceleration, one.step)
        return np.asarray(self.band.transform(one, force) + self._given[index], dtype=complex)

    def residual(self, values: Array) -> Array:
        """Weighed real and imaginary parts of all lines; ``values`` (3 K,) as in ``Fit``."""
        return np.concatenate(
            [parts(left / s) for left, s in zip(self.left(values), self._spread, strict=True)]
        )

    def left(self, values: Array) -> list[Complex]:
        """Of each run, the lines of the force that the model does not follow."""
        masses, omegas, dampings = values.reshape(3, -1)
        left = []
        for index, rigid in enumerate(self._rigid):
            lines = rigid.copy()
            for mass, omega, damping in zip(masses, omegas, dampings, strict=True):
                lines -= mass * self.column(index, omega, damping)
            left.append(lines)
        return left

    def weigh(self, values: Array) -> None:
        """Weigh every line by how much the runs differ there; ``values`` take the waves out.

        The runs have one length. A line counts for no more than ``_QUIET`` of the largest allows.
        """
        given = np.abs(np.stack(self._given))
        spread = spread_of(np.stack(self.left(values)) / np.stack(self._given))
        self._spread = list(np.maximum(spread * given, _QUIET * self.largest))

    def extended(self, values: Array) -> Array:
        """``values`` and one mode more, of the frequency that leaves least with all masses free."""
        _, omegas, dampings = values.reshape(3, -1)
        known = [self._stacked(w, z) for w, z in zip(omegas, dampings, strict=True)]
        target = np.concatenate(
            [parts(lines / s) for lines, s in zip(self._rigid, self._spread, strict=True)]
        )
        best, least = values, np.inf
        for frequency in np.linspace(self.band.low, self.band.high, _STARTS):
            omega = 2.0 * np.pi * frequency
            columns = np.stack([*known, self._stacked(omega, _DAMPING)], axis=1)
            found = np.linalg.lstsq(columns, target, rcond=None)[0]
            cost = float(np.sum((target - columns @ found) ** 2))
            if cost < least and (found > 0.0).all():
                least = cost
                best = np.concatenate([found, omegas, [omega], dampings, [_DAMPING]])
        return best

    def _stacked(self, omega: float, damping: float) -> Array:
        return np.concatenate(
            [
                parts(self.column(index, omega, damping) / self._spread[index])
                for index in range(len(self.recordings))
            ]
        )

    def solve(self, start: Array) -> tuple[Array, Array]:
        """Values (3 K,) that leave least from ``start`` on, and their covariance."""
        modes = len(start) // 3
        low = np.concatenate([np.zeros(modes), np.full(modes, 0.1), np.zeros(modes)])
        high = np.repeat([self.total, 2.0 * np.pi * self.band.high, _MOST_DAMPING], modes)
        scale = np.repeat([self.total, 2.0 * np.pi * self.band.high, 0.1], modes)
        inside = np.clip(start, low + 1e-6 * scale, high - 1e-6 * scale)
        found = least_squares(self.residual, inside, bounds=(low, high), x_scale=scale)
        freedom = max(1, len(found.fun) - len(start))
        factor = max(1.0, 2.0 * float(found.cost) / freedom)
        normal = (found.jac * scale).T @ (found.jac * scale)
        covariance = np.linalg.pinv(normal) * np.outer(scale, scale) * factor
        return np.asarray(found.x), covariance


def parts(lines: Complex) -> Array:
    """Real above imaginary parts (2 j, ...) of complex ``lines`` (j, ...)."""
    return np.concatenate([lines.real, lines.imag])
