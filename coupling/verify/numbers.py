"""Figures that the thesis prints, from their formulas: Eq. 4.6 and its ranges of Bo and We."""

from __future__ import annotations

import time

import numpy as np

from coupling.estimate.numbers import bond_number, potential_to_kinetic, weber_number
from coupling.verify.case import VerifyResult, quantity

_INCH = 0.0254


def eq46(*, resolution: int = 0) -> VerifyResult:
    """Eq. 4.6: hydrostatic over kinetic pressure, 35 inch tank, 1 Hz, 12 inches centre to peak.

    ``exact`` is what the thesis prints (1118), and a quarter of it for the reading of its text, in
    which the liquid covers a quarter of the diameter a period. The print is rounded to four digits.
    There is no grid: ``resolution`` is taken, as by every case, and changes nothing.
    """
    start = time.perf_counter()
    radius, frequency = 17.5 * _INCH, 1.0
    shaking = 12.0 * _INCH * (2.0 * np.pi * frequency) ** 2
    body_force = float(np.hypot(shaking, 9.80665))
    ratios = {
        name: potential_to_kinetic(
            body_force=body_force, radius=radius, frequency=frequency, travel=travel
        )
        for name, travel in (("as_printed", radius / 4.0), ("as_worded", radius / 2.0))
    }
    return VerifyResult(
        case="eq46",
        options={"resolution": resolution},
        quantities=(
            quantity("as_printed", ratios["as_printed"], 1118.0),
            quantity("as_worded", ratios["as_worded"], 279.5),
        ),
        wall_s=time.perf_counter() - start,
    )


def numbers(*, resolution: int = 0) -> VerifyResult:
    """Ranges of section 3.3: Bo from 2300 to 41240, We up to 1.33e6, hydrazine, 120 to 508 mm.

    ``exact`` is what the thesis prints, with the digits it prints. There is no grid: ``resolution``
    is taken, as by every case, and changes nothing.
    """
    start = time.perf_counter()
    density, surface_tension, gravity = 1010.0, 0.062, 9.81
    bond = {
        radius: bond_number(
            density=density, gravity=gravity, radius=radius, surface_tension=surface_tension
        )
        for radius in (0.120, 0.508)
    }
    weber = weber_number(
        density=density, frequency=25.0, radius=0.508, surface_tension=surface_tension
    )
    return VerifyResult(
        case="numbers",
        options={"resolution": resolution},
        quantities=(
            quantity("bond_min", bond[0.120], 2300.0),
            quantity("bond_max", bond[0.508], 41240.0),
            quantity("weber_max", weber, 1.33e6),
        ),
        wall_s=time.perf_counter() - start,
    )
