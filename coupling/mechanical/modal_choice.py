"""How many modes runs support, by leaving each run out; and what every value of a fit is worth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.mechanical.apparent_mass import Band, smoothed, unfollowed
from coupling.mechanical.modal_fit import MOST_MODES, WORTH, Fit, Problem, parts
from coupling.mechanical.modal_model import Complex, ModalModel
from coupling.mechanical.recording import Recording
from coupling.ports import Array

_HEIGHT = 1e-9  # m: of heights, what is no error at all


@dataclass(frozen=True, kw_only=True)
class Choice:
    """``fit`` of the number of modes taken; ``left_out`` by number of modes.

    The latter is the rms error of the force of runs that were left out of the fit, over its rms.
    """

    fit: Fit
    left_out: dict[int, float]


def choose(recordings: list[Recording], total: float, band: Band) -> Choice:
    """Return the model of 1 to ``MOST_MODES`` modes that runs left out support.

    A mode more is taken where it lowers the error of the runs left out by ``WORTH`` of it: a mode
    that only fits what one run shows does not.

    Parameters
    ----------
    recordings
        Two runs or more of one tank, fill and amplitude.
    total
        Mass of the liquid [kg].
    band
        Frequencies that are fitted.
    """
    problem = Problem(recordings, total, band)
    starts = _unweighed(problem)
    problem.weigh(starts[-1])
    left_out, fitted = {}, {}
    for modes, start in enumerate(starts, start=1):
        values, covariance = problem.solve(start)
        alone = _each_left_out(problem, values)
        left_out[modes] = _error(recordings, total, alone)
        fitted[modes] = values, covariance + _disagreement(alone)
    taken = 1
    for modes in range(2, len(starts) + 1):
        if left_out[modes] < (1.0 - WORTH) * left_out[taken]:
            taken = modes
    return Choice(fit=_with_heights(problem, *fitted[taken]), left_out=left_out)


def _unweighed(problem: Problem) -> list[Array]:
    """Values of fits with 1, 2 and so on modes, as far as one more can be found."""
    found = [problem.solve(problem.extended(np.zeros(0)))[0]]
    while len(found) < MOST_MODES:
        start = problem.extended(found[-1])
        if len(start) == len(found[-1]):
            break
        found.append(problem.solve(start)[0])
    return found


def _each_left_out(problem: Problem, values: Array) -> list[Array]:
    """Values of the fits that leave one run out each, from those of all on."""
    count = len(problem.recordings)
    return [problem.without(index).solve(values)[0] for index in range(count)]


def _error(recordings: list[Recording], total: float, alone: list[Array]) -> float:
    left = [
        unfollowed(one, model_of(values, total))[0]
        for one, values in zip(recordings, alone, strict=True)
    ]
    square = sum(float(np.sum(part**2)) for part in left)
    return float(np.sqrt(square / sum(float(np.sum(one.force**2)) for one in recordings)))


def _disagreement(alone: list[Array]) -> Array:
    """Covariance that fits with one run left out show (the jackknife's)."""
    spread = np.stack(alone) - np.mean(alone, axis=0)
    return np.asarray((len(alone) - 1) / len(alone) * spread.T @ spread)


def model_of(values: Array, total: float, heights: Array | None = None) -> ModalModel:
    """Model of fitted ``values`` (3 K,), its modes by rising frequency."""
    masses, omegas, dampings = values.reshape(3, -1)
    return ModalModel(
        total=total,
        masses=masses,
        omegas=omegas,
        dampings=dampings,
        heights=np.zeros(len(masses) + 1) if heights is None else heights,
    )


def _with_heights(problem: Problem, values: Array, covariance: Array) -> Fit:
    """The fit with heights from the moment, by weighed least squares."""
    order = np.argsort(values.reshape(3, -1)[1])
    places = np.concatenate([order + shift * len(order) for shift in range(3)])
    values, covariance = values[places], covariance[np.ix_(places, places)]
    model = model_of(values, problem.total)
    columns, target = [], []
    for one in problem.recordings:
        forces = model.forces(one.acceleration, one.step)
        columns.append(np.stack([problem.band.transform(one, part) for part in forces], axis=1))
        target.append(problem.band.transform(one, one.moment))
    heights, _ = _weighed(columns, target, [np.ones(len(lines)) for lines in target])
    spreads = [
        np.sqrt(0.5 * smoothed(np.abs(lines - block @ heights) ** 2))
        for block, lines in zip(columns, target, strict=True)
    ]
    floor = _HEIGHT * max(float(np.abs(block).max()) for block in columns)
    heights, error = _weighed(columns, target, [np.maximum(s, floor) for s in spreads])
    return Fit(
        model=model_of(values, problem.total, heights), covariance=covariance, heights_error=error
    )


def _weighed(
    columns: list[Complex], target: list[Complex], spread: list[Array]
) -> tuple[Array, Array]:
    """Real factors of complex ``columns`` that give ``target``, and their standard errors."""
    matrix = np.concatenate(
        [parts(block / s[:, None]) for block, s in zip(columns, spread, strict=True)]
    )
    right = np.concatenate([parts(lines / s) for lines, s in zip(target, spread, strict=True)])
    found = np.linalg.lstsq(matrix, right, rcond=None)[0]
    freedom = max(1, len(right) - len(found))
    factor = max(1.0, float(np.sum((right - matrix @ found) ** 2)) / freedom)
    covariance = np.linalg.pinv(matrix.T @ matrix) * factor
    return np.asarray(found), np.sqrt(np.diag(covariance))
