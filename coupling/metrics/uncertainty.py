"""How well the reference of a study knows its own figures: error bars from other resolutions."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from scipy.optimize import brentq

from coupling.metrics.comparison import NAMES, Errors

SECOND = {"coarser_grid": "coarsest_grid"}  # the second coarser grid beside the first
_LOWEST, _HIGHEST = 0.05, 12.0  # orders that are looked for


def error_bars(
    own: Mapping[str, Errors],
    coarsening: Mapping[str, tuple[float, float]],
    names: Sequence[str] = NAMES,
) -> Errors:
    """Estimated error of the reference in every figure of ``names``, in the figure's own unit.

    The sum of the ``shares`` of its sources: for distances between fields that is the triangle
    inequality, for amplitudes its counterpart. Where a run is missing, so is its share; None
    without any.
    """
    bars: Errors = {}
    for name in names:
        parts = [share[name] for share in shares(own, coarsening, [name]).values()]
        known = [part for part in parts if part is not None]
        bars[name] = sum(known) if known else None
    return bars


def shares(
    own: Mapping[str, Errors],
    coarsening: Mapping[str, tuple[float, float]],
    names: Sequence[str] = NAMES,
) -> dict[str, Errors]:
    """Each source's estimated error of the reference in every figure, in the figure's own unit.

    ``own``: how far each run of the reference at another resolution lies from it; ``coarsening``:
    by which factor its step, spacing or tolerance was coarser, and by which power of that the error
    falls. A run coarser by r then has r^p times the error of the reference, so that the two differ
    by r^p - 1 times: Richardson's estimate of the error, difference/|r^p - 1| (Roache, Annu. Rev.
    Fluid Mech. 29, 1997, "Quantification of uncertainty in CFD"). A finer run, r below 1, says the
    same. Where a grid has a second, still coarser one beside it (``SECOND``), ``grid_convergence``
    says the share of both. An estimate, not a bound.
    """
    found: dict[str, Errors] = {}
    for kind, (factor, order) in coarsening.items():
        if factor == 1.0 or kind not in own or kind in SECOND.values():
            continue
        second = SECOND.get(kind, "")
        far = own.get(second, {})
        found[kind] = {}
        for name in names:
            near = own[kind].get(name)
            beyond = far.get(name)
            if near is None:
                found[kind][name] = None
            elif beyond is None:
                found[kind][name] = near / abs(factor**order - 1.0)
            else:
                widths = factor, coarsening[second][0]
                found[kind][name] = grid_convergence(near, beyond, widths, order)[1]
    return found


def observed_orders(
    own: Mapping[str, Errors], coarsening: Mapping[str, tuple[float, float]]
) -> dict[str, Errors]:
    """Observed order of every figure's error, by the grid that has a second one beside it.

    None where two differences show no order.
    """
    found: dict[str, Errors] = {}
    for kind, second in SECOND.items():
        if kind not in own or second not in own or kind not in coarsening:
            continue
        (near_width, order), (far_width, _) = coarsening[kind], coarsening[second]
        found[kind] = {}
        for name, near in own[kind].items():
            far = own[second].get(name)
            if near is None or far is None:
                continue
            observed = grid_convergence(near, far, (near_width, far_width), order)[0]
            found[kind][name] = None if math.isnan(observed) else observed
    return found


def grid_convergence(
    near: float, far: float, widths: tuple[float, float], order: float
) -> tuple[float, float]:
    """Order of a grid's error as two coarser grids show it, and the estimate of that error.

    The grids differ from the finest by e (r^p - 1) each, e its error: two of them give p and e
    (Roache 1997). An order between half of ``order``, the one expected, and twice is taken, as far
    as it is not above the one expected, and e times 1.25, the grid convergence index. Any other
    says that the grids are not in the asymptotic range: 3 times e then, by the expected order, or
    by half of it where less was seen.

    Parameters
    ----------
    near, far
        Differences of the two coarser grids' results from the finest's, of any unit.
    widths
        By which factors r their cells are wider than the finest's.
    order
        Order that is expected.

    Returns
    -------
    order : float
        Observed order, NaN where the differences give none.
    error : float
        Estimate of the finest grid's error, in the unit of the differences.
    """

    def excess(power: float) -> float:
        return float((widths[1] ** power - 1.0) * near - (widths[0] ** power - 1.0) * far)

    least, most = 0.5 * order, 2.0 * order
    observed = math.nan
    if near > 0.0 and excess(_LOWEST) * excess(_HIGHEST) < 0.0:
        observed = float(brentq(excess, _LOWEST, _HIGHEST))
    trusted = least <= observed <= most
    power = max(least, min(observed, order)) if observed <= most else order
    safety = 1.25 if trusted else 3.0
    return observed, safety * near / (widths[0] ** power - 1.0)


def below(errors: Errors, bars: Errors) -> list[str]:
    """Names of the errors that are smaller than the reference's own."""
    return [
        name
        for name, value in errors.items()
        if value is not None and (bar := bars.get(name)) is not None and value < bar
    ]
