"""Which model to use, in a sentence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_ENOUGH = 0.05
LEVELS = (0.01, 0.05, 0.2)  # of relative errors: good, enough, poor
_WORDS = {
    "shape_rms": "shape",
    "cg_amplitude": "CG amplitude",
    "force_amplitude": "force amplitude",
    "pressure_rms": "pressure",
}


def advice(reference: str | None, rows: Mapping[str, Mapping[str, Any]]) -> str:
    """The fastest of the study's ``rows`` within 5 % of ``reference`` in every figure.

    The phase is left out: it is an angle, and follows the amplitudes.
    """
    if reference is None:
        return "No model completed: nothing can be advised."
    if not rows.get(reference, {}).get("error"):
        return f"The reference, {reference}, has not completed yet."
    others = {
        name: row for name, row in rows.items() if name != reference and worst(row) is not None
    }
    if not others:
        return f"Only {reference} completed: there is nothing to compare it with."
    good = [name for name, row in others.items() if (worst(row) or ("", 0.0))[1] <= _ENOUGH]
    if not good:
        name = min(others, key=lambda key: (worst(others[key]) or ("", 0.0))[1])
        what, error = worst(others[name]) or ("", 0.0)
        return (
            f"Use {reference}. The best of the others, {name}, errs by "
            f"{_percent(error)} in {_WORDS[what]}, above the {_percent(_ENOUGH)} that is asked for."
        )
    name = min(good, key=lambda key: float(others[key].get("wall_s") or 0.0))
    what, error = worst(others[name]) or ("", 0.0)
    return (
        f"Use {name}: it stays within {_percent(error, 1)} of {reference} in every "
        f"figure (worst: {_WORDS[what]}) and is "
        f"{others[name].get('speedup') or 0.0:.3g} times as fast."
    )


def _percent(value: float, digits: int = 0) -> str:
    return f"{100.0 * max(value, 0.001):.{digits}f}\u202f%"


def worst(row: Mapping[str, Any]) -> tuple[str, float] | None:
    """Name and value of the largest relative error of a study's row; None without any."""
    known = {name: row["error"].get(name) for name in _WORDS if row.get("error")}
    values = {name: float(value) for name, value in known.items() if value is not None}
    return max(values.items(), key=lambda item: item[1]) if values else None
