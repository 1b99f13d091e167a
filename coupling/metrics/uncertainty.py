"""How well the reference of a study knows its own figures: error bars from other resolutions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from coupling.metrics.comparison import NAMES, Errors


def error_bars(
    own: Mapping[str, Errors],
    coarsening: Mapping[str, tuple[float, float]],
    names: Sequence[str] = NAMES,
) -> Errors:
    """Estimated error of the reference in every figure of ``names``, in the figure's own unit.

    ``own``: how far each run of the reference at another resolution lies from it; ``coarsening``:
    by which factor its step or spacing was coarser, and by which power of that the error falls. A
    run coarser by r then has r^p times the error of the reference, so that the two differ by
    r^p - 1 times: Richardson's estimate of the error, difference/|r^p - 1| (Roache, Annu. Rev.
    Fluid Mech. 29, 1997, "Quantification of uncertainty in CFD"). Those of grid and step are
    added: for distances between fields that is the triangle inequality, for amplitudes its
    counterpart. A finer run, r below 1, says the same.

    An estimate, not a bound. With two grids the order cannot be observed, only taken from
    elsewhere; Roache's grid convergence index then asks 3 times as much, for a band to be trusted.
    Where a run is missing, so is its share; None without any.
    """
    bars: Errors = {}
    for name in names:
        parts = [
            difference / abs(factor**order - 1.0)
            for kind, (factor, order) in coarsening.items()
            if (difference := own.get(kind, {}).get(name)) is not None and factor != 1.0
        ]
        bars[name] = sum(parts) if parts else None
    return bars


def below(errors: Errors, bars: Errors) -> list[str]:
    """Names of the errors that are smaller than the reference's own."""
    return [
        name
        for name, value in errors.items()
        if value is not None and (bar := bars.get(name)) is not None and value < bar
    ]
