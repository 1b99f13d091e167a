"""Whether hydrostatics was enough for a record, by bands of frequency, in sentences."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from coupling.fluids import ASSUMED, FLUIDS
from coupling.metrics.advice import ENOUGH
from coupling.metrics.comparison import Errors
from coupling.metrics.record_errors import answered, band_name

ENOUGH_TEXT = "error and its bar together below 5\u202f%"


def record_verdict(
    reference: str,
    bands: Sequence[Mapping[str, Any]],
    errors: Mapping[str, Mapping[str, Errors]],
    bars: Mapping[str, Errors],
) -> str:
    """Which bands the tank answers to, and whether hydrostatics was enough there.

    Empty where ``errors`` hold no run of it, or the ``reference`` has no flow.
    """
    found = (errors.get(ASSUMED) or {}).get("cg")
    if not bands or not found or not FLUIDS[reference].has_flow:
        return ""
    bar = bars.get("cg") or {}
    names = [band_name((row["from_hz"], row["to_hz"])) for row in bands]
    seen = answered(bands)
    good = [name for name in names if enough(found.get(name), bar.get(name))]
    poor = [name for name in seen if name not in good]
    where = f"Nine tenths of the power of the CG's motion lies in {_joined(seen, names)}"
    if not poor:
        said = f"hydrostatics was enough there ({ENOUGH_TEXT})."
    else:
        said = "hydrostatics errs there by " + ", ".join(
            f"{_percent(found[name])} ({name})" for name in poor if found.get(name) is not None
        )
        said += ": it was not enough."
    rest = _joined(good, names)
    said += f" It was enough in {rest}." if poor and good else ""
    said += " It was enough in no band." if poor and not good else ""
    whole = found.get("all")
    if whole is None:
        return f"{where}; {said}"
    own = "" if bar.get("all") is None else f" ± {_percent(bar['all'])}"
    return (
        f"{where}; {said} Over the whole spectrum it errs by {_percent(whole)}{own} in the CG, "
        f"against {reference}."
    )


def by_range(sentence: str) -> str:
    """A ``sentence`` on amplitudes, of a record, where they are half the peak-to-peak range."""
    return sentence.replace("amplitude", "peak-to-peak range")


def enough(error: float | None, bar: float | None) -> bool:
    """Whether an ``error`` and the reference's own together are below what is asked for."""
    return error is not None and error + (bar or 0.0) <= ENOUGH


def _joined(chosen: Sequence[str], names: Sequence[str]) -> str:
    """Bands by name, neighbours joined to one."""
    runs: list[list[str]] = []
    for index, name in enumerate(names):
        if name not in chosen:
            continue
        if runs and index and names[index - 1] == runs[-1][-1]:
            runs[-1].append(name)
        else:
            runs.append([name])
    joined = [f"{run[0].split(' to ')[0]} to {run[-1].split(' to ')[1]}" for run in runs]
    return " and ".join(joined)


def _percent(value: float | None) -> str:
    size = 100.0 * max(value or 0.0, 0.001)
    return f"{size:.0f}\u202f%" if size >= 10.0 else f"{size:.2g}\u202f%"
