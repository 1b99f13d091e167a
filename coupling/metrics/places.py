"""Places on the diaphragm as it was moulded, and on the tank's shell, as two angles."""

from __future__ import annotations

import numpy as np

from coupling.ports import Array


def mould_angles(reference: Array) -> tuple[Array, Array]:
    """Return the polar angle from the pole and the azimuth from x, each (...) [rad].

    ``reference`` (..., 3) [m]: moulded points, seen from the middle of the rim; of a hemisphere
    that is the arc length's share of 90 degrees as well. The pole is that of the half space, upper
    or lower, in which they lie.
    """
    x, y, z = np.moveaxis(reference, -1, 0)
    return np.arctan2(np.hypot(x, y), np.abs(z)), np.arctan2(y, x)


def shell_angles(place: Array) -> tuple[Array, Array]:
    """Return the polar angle from the tank's lower pole and the azimuth from x, each (...) [rad].

    ``place`` (..., 3) [m], as seen from the middle of the rim, which is at 90 degrees.
    """
    x, y, z = np.moveaxis(place, -1, 0)
    return np.arctan2(np.hypot(x, y), -z), np.arctan2(y, x)


def degrees_of(polar: Array, azimuth: Array) -> tuple[float, float]:
    """Return two angles [rad] in degrees, the azimuth in [0, 360)."""
    # rounded first: -1e-15 modulo 360 is 360
    return float(np.degrees(polar)), round(float(np.degrees(azimuth)), 9) % 360.0
