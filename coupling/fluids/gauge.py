"""The gauge of dphi/dt: a potential is known up to a function of time, its rate up to a constant.

Every fluid takes the one in which the mean over the free part of the diaphragm is zero, by area.
The part that lies on the shell, above a film or none, is left out: the flow's mesh ends there.
"""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


def largest_rate(rate: Array, area: Array) -> float:
    """Return the largest |dphi/dt| on the diaphragm's free part, in the gauge of no mean over it.

    Parameters
    ----------
    rate
        -(p*/rho + |u|^2/2) on the faces of the free part (F,) [m^2/s^2], in any gauge and of either
        sign.
    area
        Areas of these faces (F,) [m^2].

    Returns
    -------
    float
        The largest magnitude [m^2/s^2].
    """
    return float(np.abs(rate - rate @ area / area.sum()).max())
