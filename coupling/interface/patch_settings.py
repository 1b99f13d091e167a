"""What the flow's patch on the diaphragm is made by: its edge, how it rounds creases, its maps."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from coupling.interface.weights import Support


@dataclass(frozen=True, kw_only=True)
class PatchSettings:
    """Constants of the patch, all without a unit; found by trial on sways at many fills.

    What each does to iterations and to the CG's motion: ``tests/benchmarks/README.md``.

    The liquid's edge, so that cells there stay open:
    - ``wedge``: its least slope; ``film``: over R, the greatest depth that this makes;
    - ``steep``: sine of the least angle at which the rim opens the liquid, about the wedge's;
    - ``smallest``: over the median inside, least area that a point inside is lifted by.

    Creases, by the size of the mean normal round a point, 1 where it is flat, and by the least
    sine of the corners of the faces round it:
    - ``smooth``, ``flat``: above the first the map is of second order, below the other of first;
    - ``flat``, ``creased``: below the first creases are rounded, below the other fully;
    - ``open``, ``sharp``: likewise for corners;
    - ``rounds``: of rounding at most; that of corners goes on to ``more``.

    ``inset``: of the contact curve, beyond which nodes have the pressure at its edge, in the
    results only. ``linear``, ``quadratic``: supports of the maps of first and second order.
    """

    wedge: float = math.tan(math.radians(15.0))
    film: float = 0.02
    steep: float = 0.25
    smallest: float = 0.5
    smooth: float = 0.997
    flat: float = 0.99
    creased: float = 0.9
    open: float = 0.5
    sharp: float = 0.2
    rounds: int = 20
    more: int = 60
    inset: float = 0.95
    linear: Support = field(default_factory=lambda: Support(reach=1.3, least=12))
    quadratic: Support = field(default_factory=lambda: Support(reach=1.8, least=20))
