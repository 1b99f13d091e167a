"""The sheet over a level liquid: the shape from which its rest is sought."""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Array
from cloth.model import ClothModel

CLOSEST = 1e-6  # of the radius, to which the level may come to a pole


def level_shape(model: ClothModel, volume: float) -> Array:
    """Positions (n, 3) [m] of a moulded hemisphere that lies flat on ``volume`` [m^3] of liquid.

    With gravity along -z and the sheet's half shell above. From the clamped rim to the level z = h
    the sheet lies on the shell, moulded for h > 0 and reflected in the rim's plane for h < 0. The
    rest, moulded at polar angles below theta_c = acos(|h|/R), is the disc r = R sin(theta_c)
    theta/theta_c: no length grows, since theta/sin(theta) does, so it is a state without tension.
    h is that of the triangles' own volume. Raises ArithmeticError where the triangles cannot hold
    the volume.
    """
    radius = model.shell_radius
    assert radius is not None
    x = model.mesh.points
    polar = np.arccos(np.clip(x[:, 2] / radius, -1.0, 1.0))
    across = np.hypot(x[:, 0], x[:, 1])
    outward = x[:, :2] / np.where(across > 0.0, across, 1.0)[:, None]

    def shape(height: float) -> Array:
        edge = math.acos(abs(height) / radius)
        flat = (polar < edge) & model.free
        result = x * np.array([1.0, 1.0, 1.0 if height >= 0.0 else -1.0])
        result[flat, :2] = (radius * math.sin(edge) / edge * polar[:, None] * outward)[flat]
        result[flat, 2] = height
        return np.where(model.free[:, None], result, model.clamped)

    most = (1.0 - CLOSEST) * radius
    least, largest = model.volume(shape(-most)), model.volume(shape(most))
    if not least < volume < largest:
        raise ArithmeticError(
            f"settling: a grid of {len(x)} nodes holds from {least:.4g} to {largest:.4g} m^3 of "
            f"liquid, got {volume:.4g}. Take a finer grid, or a fill fraction nearer to one half."
        )
    return shape(brentq(lambda h: model.volume(shape(h)) - volume, -most, most))
