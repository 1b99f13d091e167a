"""What a verification case hands back."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any


class CaseError(Exception):
    """An unknown case or a wrong option; the message lists what there is."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """A number beside its exact value, both in ``unit`` ("-" where dimensionless).

    ``error`` is |computed - exact|/|exact|, and |computed - exact| where the exact value is 0.
    """

    name: str
    computed: float
    exact: float
    error: float
    unit: str


@dataclass(frozen=True, kw_only=True)
class VerifyResult:
    """Outcome of a case run with ``options``; ``wall_s`` [s]."""

    case: str
    options: Mapping[str, Any]
    quantities: tuple[Quantity, ...]
    wall_s: float

    def to_dict(self) -> dict[str, Any]:
        """Plain values, as ``edt verify --json`` prints them."""
        return {
            "case": self.case,
            "options": dict(self.options),
            "quantities": [asdict(quantity) for quantity in self.quantities],
            "wall_s": self.wall_s,
        }


def beyond(results: Sequence[VerifyResult], tolerance: float | None) -> dict[str, str]:
    """Cases with an error above ``tolerance``, and by which quantity; none without a tolerance.

    An error that is not a number is above any.
    """
    if tolerance is None:
        return {}
    far = {
        result.case: [
            f"{one.name} errs by {one.error:.3g}"
            for one in result.quantities
            if not one.error <= tolerance
        ]
        for result in results
    }
    return {
        case: f"{', '.join(errors)}, above the tolerance of {tolerance:g}"
        for case, errors in far.items()
        if errors
    }


def quantity(name: str, computed: float, exact: float, unit: str = "-") -> Quantity:
    """``computed`` beside ``exact``, with the error as ``Quantity`` defines it."""
    difference = abs(float(computed) - float(exact))
    return Quantity(
        name=name,
        computed=float(computed),
        exact=float(exact),
        error=difference / abs(float(exact)) if exact else difference,
        unit=unit,
    )
