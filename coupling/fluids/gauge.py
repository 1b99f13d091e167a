"""The gauge of dphi/dt: a potential is known up to a function of time, its rate up to a constant.

Every fluid takes the one in which the mean over the free part of the diaphragm is zero, by area.
The part that lies on the shell, above a film or none, is left out: the flow's mesh ends there.
"""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


def largest_rate(rate: Array, area: Array) -> float:
    """Largest |dphi/dt| [m^2/s^2] on the diaphragm's free part, in the gauge of no mean over it.

    ``rate`` (F,) [m^2/s^2]: -(p*/rho + |u|^2/2) on its faces, in any gauge; ``area`` (F,) [m^2].
    """
    return float(np.abs(rate - rate @ area / area.sum()).max())
