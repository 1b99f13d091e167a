"""How wrong hydrostatics is and which model to use, a sentence each, error bars counted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from coupling.fluids import ASSUMED, FLUIDS
from coupling.metrics.comparison import Errors

Row = Mapping[str, Any]
_Known = Mapping[str, Mapping[str, float]]  # errors by row and figure

LEVELS = (0.01, 0.05, 0.2)  # of relative errors: good, enough, poor
ENOUGH = LEVELS[1]
UNKNOWN = 1.0  # relative error bar of a reference's own figure beyond which it says nothing
_WORDS = {
    "shape_rms": "shape",
    "cg_amplitude": "CG amplitude",
    "force_amplitude": "force amplitude",
    "pressure_rms": "pressure",
}


def verdict(reference: str | None, rows: Mapping[str, Row], bars: Errors) -> str:
    """How wrong the hydrostatic pressure is in the CG's amplitude and phase.

    Empty where ``rows`` hold no completed run of it beside the ``reference``.
    """
    errors = rows.get(ASSUMED, {}).get("error") or {}
    amplitude, bar = errors.get("cg_amplitude"), bars.get("cg_amplitude")
    if reference is None or not FLUIDS[reference].has_flow or amplitude is None:
        return ""
    phase, turn = errors.get("cg_phase_deg"), bars.get("cg_phase_deg")
    late = ""
    if phase is not None and (turn is None or phase >= turn):
        late = f"by {phase:.2g}°" + ("" if turn is None else f" ± {turn:.2g}°")
    if bar is not None and amplitude < bar:
        unresolved = (
            f"{_percent(amplitude)} in the CG amplitude, which is within the {_percent(bar)} that "
            f"{reference} itself may err by"
        )
        if late:
            against = f"in the CG phase, against {reference}"
            return f"Hydrostatics errs {late} {against}, and by {unresolved}."
        return f"Hydrostatics errs by {unresolved}: no difference can be resolved."
    said = f"Hydrostatics errs by {_with_bar(amplitude, bar)} in the CG amplitude"
    return said + (f" and {late} in its phase" if late else "") + f", against {reference}."


def advice(reference: str | None, rows: Mapping[str, Row], bars: Errors | None = None) -> str:
    """The fastest of the study's ladder that is within 5 % of ``reference`` in every figure.

    Within counts the error bar. Where none is, the fastest that the bars do not separate from the
    reference: each of its errors is below 5 % or below the bar. The phase is left out: it is an
    angle, and follows the amplitudes; so is a figure with a bar above 100 %. The thesis' algorithm
    and what only changes the diaphragm are not advised.
    """
    bars = bars or {}
    if reference is None:
        return "No model completed: nothing can be advised."
    unknown = [figure for figure in _WORDS if (bars.get(figure) or 0.0) > UNKNOWN]
    unknown = unknown if len(unknown) < len(_WORDS) else []
    advised = _advice(reference, rows, bars, unknown)
    if not unknown:
        return advised
    named = " and ".join(_WORDS[figure] for figure in unknown)
    return f"{advised} It leaves out {named}, which {reference} itself does not resolve."


def _advice(reference: str, rows: Mapping[str, Row], bars: Errors, unknown: Sequence[str]) -> str:
    """As ``advice``, without the figures of ``unknown``."""
    if not rows.get(reference, {}).get("error"):
        return f"The reference, {reference}, has not completed yet."
    others = {
        name: found
        for name, row in rows.items()
        if name not in (reference, "thesis") and row.get("model", name) == name
        if (found := {k: v for k, v in _relative(row).items() if k not in unknown})
    }
    if not others:
        return f"Only {reference} completed: there is nothing to compare it with."

    return (
        _within(reference, rows, others, bars)
        or _alike(reference, rows, others, bars)
        or _too_far(reference, others, bars)
    )


def _within(reference: str, rows: Mapping[str, Row], others: _Known, bars: Errors) -> str:
    """On the fastest whose errors and bars together stay below what is asked for, if any."""
    reach = {
        name: max((error + (bars.get(figure) or 0.0), figure) for figure, error in errors.items())
        for name, errors in others.items()
    }
    good = [name for name, (most, _) in reach.items() if most <= ENOUGH]
    if not good:
        return ""
    name = _fastest(good, rows)
    most, figure = reach[name]
    return (
        f"Use {name}: it stays within {_percent(most, 1)} of {reference} in every figure, "
        f"error bars included (worst: {_WORDS[figure]}), and is {_speed(rows[name])}."
    )


def _alike(reference: str, rows: Mapping[str, Row], others: _Known, bars: Errors) -> str:
    """On the fastest that the bars do not separate from the reference, if any."""
    alike = [name for name, errors in others.items() if not _resolved(errors, bars)]
    if not alike:
        return ""
    name = _fastest(alike, rows)
    figure, error = _worst(others[name])
    return (
        f"Use {name}: the error bars do not separate it from {reference} (worst: "
        f"{_with_bar(error, bars.get(figure))} in {_WORDS[figure]}), and is {_speed(rows[name])}. "
        f"Whether it is within {_percent(ENOUGH)} takes a finer {reference} to say."
    )


def _too_far(reference: str, others: _Known, bars: Errors) -> str:
    resolved = {name: _resolved(errors, bars) for name, errors in others.items()}
    name = min(resolved, key=lambda key: _worst(resolved[key])[1])
    figure, error = _worst(resolved[name])
    return (
        f"Use {reference}. The best of the others, {name}, errs by "
        f"{_with_bar(error, bars.get(figure))} in {_WORDS[figure]}, above the "
        f"{_percent(ENOUGH)} that is asked for."
    )


def _resolved(errors: Mapping[str, float], bars: Errors) -> dict[str, float]:
    """The errors above what is asked for that the reference's own cannot explain."""
    return {
        figure: error
        for figure, error in errors.items()
        if error > max(ENOUGH, bars.get(figure) or 0.0)
    }


def _worst(errors: Mapping[str, float]) -> tuple[str, float]:
    return max(errors.items(), key=lambda item: item[1])


def _fastest(names: Sequence[str], rows: Mapping[str, Row]) -> str:
    return min(names, key=lambda name: float(rows[name].get("wall_s") or 0.0))


def _speed(row: Row) -> str:
    return f"{row.get('speedup') or 0.0:.3g} times as fast"


def _percent(value: float, digits: int = 0) -> str:
    return f"{100.0 * max(value, 0.001):.{digits}f}\u202f%"


def _with_bar(value: float, bar: float | None) -> str:
    return _percent(value) if bar is None else f"{_percent(value)} ± {_percent(bar)}"


def _relative(row: Row) -> dict[str, float]:
    """The relative errors of a study's row that are known, by figure."""
    errors = row.get("error") or {}
    return {name: float(errors[name]) for name in _WORDS if errors.get(name) is not None}
