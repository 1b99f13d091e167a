"""A tank shaken by a random record that is made from power spectral densities."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

import numpy as np

from coupling.motion.kind import MotionKind, TankMotion
from coupling.motion.table import TableMotion
from coupling.ports import Array
from coupling.scene.motion_table import MotionTable
from coupling.scene.sections import Motion
from coupling.scene.spectrum_table import SpectrumTable
from coupling.scene.tables.columns import GRAVITY
from coupling.scene.tables.text import TableError

MOST_HARMONICS = 200_000  # 20 samples of each take 100 MB
_SAMPLES = 20  # in a period of the highest harmonic
_ROUNDING = 1e-9


@lru_cache(maxsize=2)  # a run asks for the same record again and again
def record_of(table: SpectrumTable, seed: int, duration: float) -> MotionTable:
    """A record with the densities of ``table``, the sum of harmonics with random phases.

    Shinozuka and Jan (J. Sound and Vibration 25, 1972): the harmonic k/``duration`` has the power
    of the table within 0.5/``duration`` [s] of it, and a phase that is even in (0, 2 pi) by the
    ``seed``, another one on each axis. So the record's power is the table's, whatever the seed, and
    it has a period of ``duration``. It is sampled 20 times in a period of the highest harmonic.
    The line between two samples has (sin(x)/x)^2 of a harmonic of frequency f, x = pi f over the
    rate of the samples; the harmonics are enlarged by that, 0.8 % at the most.
    """
    from scipy.fft import next_fast_len

    count = math.ceil(table.band[1] * duration + 0.5)
    edges = np.arange(0.5, count + 1.0) / duration
    power = np.diff(table.power_below(edges), axis=0)
    samples = next_fast_len(_SAMPLES * count, real=True)
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, (count, 3))
    lines = np.zeros((samples // 2 + 1, 3), dtype=np.complex128)
    kept = np.sinc(np.arange(1, count + 1) / samples)[:, None] ** 2
    lines[1 : count + 1] = 0.5 * samples * np.sqrt(2.0 * power) / kept * np.exp(1j * phase)
    signal = np.fft.irfft(lines, samples, axis=0)
    low, high = table.band
    return MotionTable(
        time=np.linspace(0.0, duration, samples + 1),
        acceleration=np.vstack([signal, signal[:1]]),
        read=f"made of {table.read}, {low:g} to {high:g} Hz, {_in_g(table.rms)} g rms: "
        f"{np.count_nonzero(power.any(axis=1))} harmonics, seed {seed}",
    )


def _in_g(rms: Array) -> str:
    return "(" + ", ".join(f"{value:.3g}" for value in rms / GRAVITY) + ")"


class PeriodicMotion(TableMotion):
    """The motion of one period of a ``table``, which is where it was when the period is over.

    It has the velocity at time 0 that this takes; the liquid feels the acceleration alone.
    """

    def __init__(self, table: MotionTable) -> None:
        super().__init__(table)
        period = float(table.time[-1])
        self._drift = super().displacement(period) / period

    def displacement(self, time: float) -> Array:
        """Second integral from time 0 [m], less its drift."""
        return super().displacement(time) - self._drift * time

    def velocity(self, time: float) -> Array:
        """First integral [m/s], of no mean."""
        return super().velocity(time) - self._drift


class Psd(MotionKind):
    """A random record with given power spectral densities (``record_of``)."""

    needs = ("file", "duration", "seed")
    reads_file = True

    def motion(self, section: Motion) -> TankMotion:
        """Of the record that ``section`` describes."""
        return PeriodicMotion(self.record(section))

    def record(self, section: Motion) -> MotionTable:
        """The one that ``section`` describes."""
        assert section.duration is not None
        assert section.seed is not None
        return record_of(section.spectrum, section.seed, section.duration)

    def problems(self, section: Motion, end: float, step: float) -> list[str]:
        """A table that cannot be read, energy that the steps or the record cannot carry."""
        if section.file is None or section.duration is None:  # said of the missing key
            return []
        try:
            low, high = section.spectrum.band
        except TableError as error:
            return [f"motion.file: {error}"]
        where, duration, carried = f"motion.file: {section.file}", section.duration, 0.5 / step
        if high == 0.0:
            return [f'{where}: all densities are 0. Give some, or take motion.kind = "rest".']
        problems = []
        if high > carried * (1.0 + _ROUNDING):
            problems.append(
                f"{where}: has energy up to {high:g} Hz, and steps of time.step = {step:g} s carry "
                f"{carried:g} Hz. Give time.step = {_below(0.5 / high):g} or less, or end the "
                f"table at {_below(carried):g} Hz or below if the liquid does not feel the rest."
            )
        if low * duration < 1.0 - _ROUNDING:
            problems.append(
                f"{where}: has energy from {low:g} Hz on, and a record of motion.duration = "
                f"{duration:g} s holds nothing below {1.0 / duration:.4g} Hz. Give motion.duration "
                f"= {math.ceil(1.0 / low)} or more, or start the table at a higher frequency."
            )
        if high * duration > MOST_HARMONICS:
            problems.append(
                f"motion.duration: makes {high * duration:.3g} harmonics, got {duration:g} s; at "
                f"most {MOST_HARMONICS} are summed. Give a shorter record."
            )
        if duration < end * (1.0 - _ROUNDING):
            problems.append(
                f"motion.duration: must cover 0 to {end:g} s, got {duration:g}. Give {end:g} or "
                "more, or shorten time.duration."
            )
        return problems

    def characteristic_frequency(self, section: Motion) -> float:
        """That of the record."""
        return self.record(section).characteristic_frequency

    def peak_accelerations(self, section: Motion) -> Array:
        """All of the record's samples, within the run or not."""
        return self.record(section).acceleration

    def facts(self, section: Motion) -> tuple[str | tuple[float, str], ...]:
        """The table's name, its band, the rms and the seed."""
        low, high = section.spectrum.band
        return (
            f"spectrum {Path(section.file or '').name}",
            f"{low:g} to {high:g} Hz",
            f"{_in_g(section.spectrum.rms)} g rms",
            f"seed {section.seed}",
        )


def _below(value: float) -> float:
    """``value`` to three digits, never above it."""
    digits = 2 - math.floor(math.log10(value))
    return math.floor(value * 10.0**digits + _ROUNDING) / 10.0**digits


PSD = Psd()
