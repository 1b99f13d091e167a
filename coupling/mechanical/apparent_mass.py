"""Apparent mass against frequency: what runs have shown, and how far it is one of a linear tank.

A finite run of a tank that hardly damps its waves ends before they have died away. So the force of
a model, which has the same waves, is subtracted first: what is left is small, and so is what its
transform errs by for ending. The apparent mass is the model's plus what is left over -a (the
residual-corrected estimate), which does not hang on the model where it fits.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from coupling.mechanical.modal_model import ModalModel
from coupling.mechanical.recording import Recording
from coupling.ports import Array

NEIGHBOURS = 2  # lines on either side that a spread is averaged over


@dataclass(frozen=True, kw_only=True)
class Band:
    """Frequencies [Hz] between which runs are transformed, both kept."""

    low: float
    high: float

    def lines(self, recording: Recording) -> tuple[Array, NDArray[np.bool_]]:
        """All frequencies (m,) [Hz] of a run's transform, and which of them lie in the band."""
        count, step = len(recording.force), recording.step
        frequency: Array = np.asarray(np.fft.rfftfreq(count, step), dtype=np.float64)
        return frequency, (frequency >= self.low) & (frequency <= self.high)

    def transform(self, recording: Recording, signal: Array) -> NDArray[np.complex128]:
        """Transform of ``signal`` (n,) [u] at the band's lines (j,) [u s]."""
        _, inside = self.lines(recording)
        return np.asarray(recording.step * np.fft.rfft(signal)[inside])

    def frequencies(self, recording: Recording) -> Array:
        """The band's lines (j,) [Hz]."""
        frequency, inside = self.lines(recording)
        return np.asarray(frequency[inside])


@dataclass(frozen=True, kw_only=True)
class ApparentMass:
    """What runs of one length have shown at J frequencies [Hz].

    ``mass`` (J,) [kg], complex: force over -acceleration; ``mass_error`` (J,) [kg]: standard error
    of its parts; ``moment``, ``moment_error`` (J,) [kg m]: the same of the moment; ``coherence``
    (J,): |M|^2 over |M|^2 and the variance between runs.
    """

    frequency: Array
    mass: NDArray[np.complex128]
    mass_error: Array
    moment: NDArray[np.complex128]
    moment_error: Array
    coherence: Array


def apparent_mass(recordings: list[Recording], model: ModalModel, band: Band) -> ApparentMass:
    """Return the apparent mass of two runs or more of one length, with a model near to them.

    Errors are by how much the runs differ: noise of the solver, and motion that is not linear,
    which another course of the same frequencies shows in another way.
    """
    frequency = band.frequencies(recordings[0])
    omega = 2.0 * np.pi * frequency
    answers = model.apparent_mass(omega), model.apparent_moment(omega)
    left = [unfollowed(one, model) for one in recordings]
    means, errors = [], []
    for index, answer in enumerate(answers):
        each = np.stack(
            [
                answer - band.transform(one, parts[index]) / band.transform(one, one.acceleration)
                for one, parts in zip(recordings, left, strict=True)
            ]
        )
        means.append(each.mean(axis=0))
        errors.append(spread_of(each) / np.sqrt(len(each)))
    variance = 2.0 * len(recordings) * errors[0] ** 2  # of a run, of both parts
    power = np.abs(means[0]) ** 2
    return ApparentMass(
        frequency=frequency,
        mass=means[0],
        mass_error=errors[0],
        moment=means[1],
        moment_error=errors[1],
        coherence=power / (power + variance),
    )


def spread_of(each: NDArray[np.complex128]) -> Array:
    """Standard deviation (J,) of either part of what runs show (runs, J), smoothed over lines."""
    square = np.sum(np.abs(each - each.mean(axis=0)) ** 2, axis=0) / (len(each) - 1)
    return np.sqrt(0.5 * smoothed(square))


def unfollowed(recording: Recording, model: ModalModel) -> tuple[Array, Array]:
    """Force (n,) [N] and moment (n,) [N m] of a run less those of ``model``."""
    forces = model.forces(recording.acceleration, recording.step)
    return recording.force - forces.sum(axis=0), recording.moment - model.heights @ forces


def smoothed(power: Array) -> Array:
    """Running mean of ``power`` (J,) over ``NEIGHBOURS`` on either side, fewer at the ends."""
    window = np.ones(2 * NEIGHBOURS + 1)
    count = np.convolve(np.ones_like(power), window, mode="same")
    return np.asarray(np.convolve(power, window, mode="same") / count)
