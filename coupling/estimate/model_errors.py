"""How far each fluid model will be off for a scene, before anything is run: fitted to our own runs.

The data, ``model_errors.csv``, are CG motions of sine scenes run on one rung of the ladder and on a
better one. How they were made stands in ``foam_cases/sway_map``. The error is that of the complex
first harmonic, |c - c_ref|/|c_ref|: amplitude and phase in one number.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files

import numpy as np

from coupling.estimate.numbers import numbers_of
from coupling.fluids import FLUIDS
from coupling.fluids.model import Law
from coupling.ports import Array
from coupling.scene.scene import Scene

DATA = "model_errors.csv"
PLACE = ("frequency_ratio", "acceleration_ratio", "fill_fraction")
COLUMNS = ("model", "reference", *PLACE, "error")
QUANTITIES = ("f/f1", "a/g", "fill fraction")
SHARE = 0.9  # of the data that lie below an upper bound
_DEGREES = (0, 1, 2)
_FLOOR = 1e-6  # errors below are the solvers' own noise


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """Relative error of a CG motion: the ``expected`` one, and an ``upper`` bound that nine in ten
    scenes keep. ``outside`` names what lies beyond the data, whose nearest edge then speaks."""

    expected: float
    upper: float
    outside: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One row of the data: ``model`` against ``reference`` in a scene at these ``coordinates``."""

    model: str
    reference: str
    coordinates: Array
    error: float


def coordinates(
    *, frequency_ratio: float, acceleration_ratio: float, fill_fraction: float
) -> Array:
    """What an estimate depends on (3,): log10 of f/f1 and of 1 + a/g, and the fill fraction.

    Not log10 of a/g: gentle motion is linear, and its errors do not depend on how gentle it is.
    """
    ratio = max(frequency_ratio, 1e-12)
    return np.array([np.log10(ratio), np.log10(1.0 + acceleration_ratio), fill_fraction])


@dataclass(frozen=True, kw_only=True)
class ErrorFit:
    """An error over its ``law`` in f/f1: log10 of that is a polynomial of a scene's coordinates.

    ``powers`` (k, 3) of the coordinates; ``coefficients`` (k,); ``missed`` (n,): by how much the
    data lie above a fit that each is left out of; ``low``, ``high`` (3,): range of the data.
    """

    law: Law
    powers: Array
    coefficients: Array
    missed: Array
    low: Array
    high: Array

    def at(self, given: Array) -> Estimate:
        """The estimate at coordinates (3,); those beyond the data are taken at the data's edge."""
        inside = np.clip(given, self.low, self.high)
        beyond = np.abs(given - inside) > 1e-9 * np.maximum(1.0, np.abs(given))
        log = float(_terms(inside[None], self.powers)[0] @ self.coefficients)
        expected = float(self.law(10.0 ** inside[0])) * 10.0**log
        return Estimate(
            expected=expected,
            upper=expected * float(10.0 ** np.quantile(self.missed, SHARE)),
            outside=tuple(name for name, out in zip(QUANTITIES, beyond, strict=True) if out),
        )


def fit_errors(rows: Sequence[Measured], law: Law) -> ErrorFit:
    """Least squares fit of ``rows``, of that degree whose left-out data miss least (rms).

    ``ValueError`` with fewer than six.
    """
    if len(rows) < 6:
        raise ValueError(f"model errors: a fit takes six rows or more, got {len(rows)}")
    points = np.array([row.coordinates for row in rows])
    errors = np.maximum([row.error for row in rows], _FLOOR)
    logs = np.log10(errors / law(10.0 ** points[:, 0]))
    fits = [_fit(points, logs, degree, law) for degree in _DEGREES]
    return min(fits, key=lambda fit: float(np.mean(fit.missed**2)))


def _fit(points: Array, logs: Array, degree: int, law: Law) -> ErrorFit:
    powers = np.array(
        [p for p in np.ndindex(degree + 1, degree + 1, degree + 1) if sum(p) <= degree], dtype=float
    )
    terms = _terms(points, powers)
    inverse = np.linalg.pinv(terms)
    coefficients = np.asarray(inverse @ logs, dtype=np.float64)
    rest = 1.0 - np.einsum("ij,ji->i", terms, inverse)
    alone = rest < 1e-6  # a row without which the fit would be open
    return ErrorFit(
        law=law,
        powers=powers,
        coefficients=coefficients,
        missed=np.where(alone, np.inf, (logs - terms @ coefficients) / np.where(alone, 1.0, rest)),
        low=points.min(axis=0),
        high=points.max(axis=0),
    )


def _terms(points: Array, powers: Array) -> Array:
    return np.asarray(np.prod(points[:, None, :] ** powers[None], axis=2))


@cache
def fitted(model: str) -> ErrorFit:
    """The fit of ``model`` to the data that come with the program."""
    lines = (files("coupling.estimate") / DATA).read_text(encoding="utf-8").splitlines()
    law = FLUIDS[model].error_law
    assert law is not None
    return fit_errors([row for row in read_rows(lines) if row.model == model], law.law)


def read_rows(lines: Iterable[str]) -> list[Measured]:
    """Rows of a CSV with the columns COLUMNS."""
    return [
        Measured(
            model=row["model"],
            reference=row["reference"],
            coordinates=coordinates(**{name: float(row[name]) for name in PLACE}),
            error=float(row["error"]),
        )
        for row in csv.DictReader(lines)
    ]


def ladder() -> tuple[str, ...]:
    """The fluid models whose errors are known, the simplest first."""
    return tuple(name for name in FLUIDS if FLUIDS[name].error_law is not None)


def estimates(scene: Scene) -> dict[str, Estimate]:
    """Estimated error in ``scene`` of every fluid model that has data.

    Where the data were measured against the next model, that one's own error is added in
    quadrature; that of a flow's mesh is taken to the scene's mesh (``FluidModel.error_scale``). All
    are zero at rest, where the liquid is hydrostatic exactly, and unknown of a free tank.
    """
    numbers, names = numbers_of(scene), ladder()
    if scene.carrier.free:
        unknown = Estimate(expected=math.nan, upper=math.nan, outside=("carrier",))
        return dict.fromkeys(names, unknown)
    if numbers.acceleration_ratio == 0.0:
        return {name: Estimate(expected=0.0, upper=0.0) for name in names}
    place = coordinates(**{name: getattr(numbers, name) for name in PLACE})
    found: dict[str, Estimate] = {}
    above: Estimate | None = None
    for name in reversed(names):
        model = FLUIDS[name]
        own, scale = fitted(name).at(place), model.error_scale(scene)
        own = replace(own, expected=scale * own.expected, upper=scale * own.upper)
        assert model.error_law is not None
        if model.error_law.adds_next and above is not None:
            own = _together(own, above)
        found[name] = above = own
    return {name: found[name] for name in names}


def _together(own: Estimate, above: Estimate) -> Estimate:
    return Estimate(
        expected=float(np.hypot(own.expected, above.expected)),
        upper=float(np.hypot(own.upper, above.upper)),
        outside=tuple(dict.fromkeys((*own.outside, *above.outside))),
    )


@dataclass(frozen=True, kw_only=True)
class Choice:
    """``fluid`` chosen, the ``reason`` in a sentence, and the ``estimates`` that it rests on."""

    fluid: str
    reason: str
    estimates: Mapping[str, Estimate]


def choose(scene: Scene) -> Choice:
    """The cheaper model without a mesh whose error keeps ``model.tolerance`` in nine scenes of ten.

    Where none does it is the one of the least upper bound, and the reason says so. A flow on a mesh
    is never taken: what its mesh errs by was as large as what the best model without one leaves
    out in all scenes of ``foam_cases/auto_check`` but one, at ten times the cost.
    """
    known, kept = estimates(scene), f"{scene.model.tolerance:.3g} in nine scenes of ten"
    meshless = [fluid for fluid in known if FLUIDS[fluid].coarser(scene) is None]
    if scene.carrier.free:
        reason = "the known errors are of prescribed motions, and a free tank feels the waves in it"
        return Choice(fluid=meshless[-1], reason=reason, estimates=known)
    for fluid in meshless:
        if known[fluid].upper <= scene.model.tolerance:
            reason = f"{fluid} is the cheapest that keeps {kept}: {_figures(known[fluid])}"
            return Choice(fluid=fluid, reason=reason, estimates=known)
    best = min(meshless, key=lambda fluid: known[fluid].upper)
    reason = f"no model without a mesh keeps {kept}; {best} errs least: {_figures(known[best])}"
    return Choice(fluid=best, reason=reason, estimates=known)


def _figures(one: Estimate) -> str:
    """Expected error, its bound, and whether the data reach so far."""
    text = (
        f"it is expected to err by {one.expected:.2g} in the CG motion, nine in ten below "
        f"{one.upper:.2g}"
    )
    if one.outside:
        many = "s" if len(one.outside) == 1 else ""
        text += f" (by the nearest data: {', '.join(one.outside)} lie{many} beyond them)"
    return text
