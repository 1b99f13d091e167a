"""How far each fluid model will be off for a scene, before anything is run: fitted to our own runs.

The data, ``model_errors.csv``, are CG motions of sine scenes run on one rung of the ladder and on a
better one. How they were made stands in ``foam_cases/sway_map``. The error is that of the complex
first harmonic, |c - c_ref|/|c_ref|: amplitude and phase in one number.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from pathlib import Path

import numpy as np

from coupling.motion_table import read_motion_table
from coupling.numbers import numbers_of
from coupling.ports import Array
from coupling.scene import Scene

DATA = "model_errors.csv"
LADDER = ("hydrostatic", "potential", "openfoam")
CELLS = 1300  # of the flow's mesh in the data
COLUMNS = (
    "model", "reference", "frequency_ratio", "acceleration_ratio", "fill_fraction", "error",
)  # fmt: skip
QUANTITIES = ("f/f1", "a/g", "fill fraction")
QUANTILE = 1.2816  # of the normal distribution: nine in ten lie below
POWER = 0.9  # of a table's acceleration that lies below its characteristic frequency
_FLOOR = 1e-6  # errors below are the solvers' own noise


@dataclass(frozen=True, kw_only=True)
class Shaking:
    """What an estimate depends on: ``frequency_ratio`` f/f1, ``acceleration_ratio`` a/g of the
    largest tank acceleration, ``fill_fraction``; the first two are 0 at rest."""

    frequency_ratio: float
    acceleration_ratio: float
    fill_fraction: float

    @property
    def coordinates(self) -> Array:
        """(3,): logarithms to base 10 of the ratios, and the fill fraction."""
        ratios = np.array([self.frequency_ratio, self.acceleration_ratio])
        return np.append(np.log10(np.maximum(ratios, 1e-12)), self.fill_fraction)


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """Relative error of a CG motion: the ``expected`` one, and an ``upper`` bound that nine in ten
    scenes keep. ``outside`` names what lies beyond the data, whose nearest edge then speaks."""

    expected: float
    upper: float
    outside: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One row of the data: ``model`` against ``reference`` in a scene of this ``shaking``."""

    model: str
    reference: str
    shaking: Shaking
    error: float


def shaking_of(scene: Scene) -> Shaking:
    """Of a sine, its own; of a table, the frequency that POWER of its acceleration lies below.

    ``TableError`` if the table has changed since the scene was read and is now wrong.
    """
    numbers, gravity = numbers_of(scene), float(np.linalg.norm(scene.gravity))
    frequency, acceleration = 0.0, 0.0
    motion = scene.motion
    if motion.kind == "sine" and motion.frequency and motion.amplitude:
        frequency = motion.frequency
        acceleration = motion.amplitude * (2.0 * np.pi * frequency) ** 2
    elif motion.kind == "table" and motion.file:
        table = read_motion_table(Path(motion.file))
        frequency = characteristic_frequency(table.time, table.acceleration)
        acceleration = float(np.linalg.norm(table.acceleration, axis=1).max())
    return Shaking(
        frequency_ratio=frequency / numbers.slosh_frequency,
        acceleration_ratio=acceleration / gravity,
        fill_fraction=scene.liquid.fill_fraction,
    )


def characteristic_frequency(time: Array, acceleration: Array) -> float:
    """Frequency [Hz] below which POWER of the acceleration's energy lies, its mean left out.

    ``time`` (T,) [s], ``acceleration`` (T, 3) [m/s^2], linear in between. 0 where nothing moves.
    """
    if len(time) < 2:
        return 0.0
    even = np.linspace(time[0], time[-1], max(4 * len(time), 64))
    signal = np.stack([np.interp(even, time, part) for part in acceleration.T], axis=1)
    spectrum = np.abs(np.fft.rfft(signal - signal.mean(axis=0), axis=0)) ** 2
    energy = np.cumsum(spectrum.sum(axis=1))
    if energy[-1] <= 0.0:
        return 0.0
    frequencies = np.fft.rfftfreq(len(even), even[1] - even[0])
    return float(frequencies[np.searchsorted(energy, POWER * energy[-1])])


@dataclass(frozen=True, kw_only=True)
class ErrorFit:
    """log10 of an error as a polynomial of the shaking's coordinates, by least squares.

    ``powers`` (k, 3) of the coordinates; ``coefficients`` (k,); ``spread``: rms of what the data
    miss when each is left out of its own fit; ``low``, ``high`` (3,): range of the data.
    """

    powers: Array
    coefficients: Array
    spread: float
    low: Array
    high: Array

    def at(self, shaking: Shaking) -> Estimate:
        """The estimate for a scene; coordinates beyond the data are taken at the data's edge."""
        given = shaking.coordinates
        inside = np.clip(given, self.low, self.high)
        beyond = np.abs(given - inside) > 1e-9 * np.maximum(1.0, np.abs(given))
        log = float(_terms(inside[None], self.powers)[0] @ self.coefficients)
        return Estimate(
            expected=float(10.0**log),
            upper=float(10.0 ** (log + QUANTILE * self.spread)),
            outside=tuple(
                name for name, out in zip(QUANTITIES, beyond, strict=True) if out
            ),
        )


def fit_errors(rows: Sequence[Measured]) -> ErrorFit:
    """Fit of ``rows``: of second degree from thirty on, else linear.

    ``ValueError`` with fewer than six.
    """
    if len(rows) < 6:
        raise ValueError(f"model errors: a fit takes six rows or more, got {len(rows)}")
    degree = 2 if len(rows) >= 30 else 1
    powers = np.array(
        [p for p in np.ndindex(degree + 1, degree + 1, degree + 1) if sum(p) <= degree], dtype=float
    )
    points = np.array([row.shaking.coordinates for row in rows])
    logs = np.log10(np.maximum([row.error for row in rows], _FLOOR))
    terms = _terms(points, powers)
    inverse = np.linalg.pinv(terms)
    coefficients = inverse @ logs
    leverage = np.einsum("ij,ji->i", terms, inverse)
    missed = (logs - terms @ coefficients) / np.maximum(1.0 - leverage, 1e-6)
    return ErrorFit(
        powers=powers,
        coefficients=coefficients,
        spread=float(np.sqrt(np.mean(missed**2))),
        low=points.min(axis=0),
        high=points.max(axis=0),
    )


def _terms(points: Array, powers: Array) -> Array:
    return np.asarray(np.prod(points[:, None, :] ** powers[None], axis=2))


@cache
def fitted(model: str) -> ErrorFit:
    """The fit of ``model`` to the data that come with the program."""
    lines = (files("coupling") / DATA).read_text(encoding="utf-8").splitlines()
    return fit_errors([row for row in read_rows(lines) if row.model == model])


def read_rows(lines: Iterable[str]) -> list[Measured]:
    """Rows of a CSV with the columns COLUMNS."""
    return [
        Measured(
            model=row["model"],
            reference=row["reference"],
            shaking=Shaking(
                frequency_ratio=float(row["frequency_ratio"]),
                acceleration_ratio=float(row["acceleration_ratio"]),
                fill_fraction=float(row["fill_fraction"]),
            ),
            error=float(row["error"]),
        )
        for row in csv.DictReader(lines)
    ]


def estimates(scene: Scene) -> dict[str, Estimate]:
    """Estimated error of ``hydrostatic``, ``potential`` and ``openfoam`` in ``scene``.

    That of ``hydrostatic`` is its error against ``potential`` with that one's against ``openfoam``
    added in quadrature; that of ``openfoam`` is its grid's, which falls as the square of the cells'
    size. All are zero at rest, where the liquid is hydrostatic exactly.
    """
    shaking = shaking_of(scene)
    if shaking.acceleration_ratio == 0.0:
        return {name: Estimate(expected=0.0, upper=0.0) for name in LADDER}
    hydrostatic, potential, openfoam = (fitted(name).at(shaking) for name in LADDER)
    finer = (CELLS / scene.openfoam.cells) ** (2.0 / 3.0)
    return {
        "hydrostatic": _together(hydrostatic, potential),
        "potential": potential,
        "openfoam": replace(
            openfoam, expected=finer * openfoam.expected, upper=finer * openfoam.upper
        ),
    }


def _together(own: Estimate, above: Estimate) -> Estimate:
    return Estimate(
        expected=float(np.hypot(own.expected, above.expected)),
        upper=float(np.hypot(own.upper, above.upper)),
        outside=tuple(dict.fromkeys((*own.outside, *above.outside))),
    )
