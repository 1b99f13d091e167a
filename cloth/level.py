"""The sheet over a level liquid: the shape from which its rest is sought."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Array
from cloth.model import ClothModel

CLOSEST = 1e-6  # of the way to a pole, to which the level does not come


def level_shape(model: ClothModel, volume: float) -> Array:
    """Return positions (n, 3) [m] of a moulded sheet that lies flat on ``volume`` [m^3] of liquid.

    With gravity along -z. From the clamped rim to the level z = h the sheet lies on the shell, up
    or down it, each ring as far from the rim along the shell's meridian as it is moulded. The rest,
    moulded nearer to the pole than s_c, is the disc r = r_c s/s_c, with s the moulded arc length
    from the pole and r_c the shell's radius at h. In a sphere whose upper or lower half the sheet
    was moulded to no length grows, since theta/sin(theta) does: it is a state without tension. h is
    that of the triangles' own volume. Raises ArithmeticError where the triangles cannot hold the
    volume.
    """
    x, shell = model.mesh.points, model.shell
    rim_distance = model.mesh.rim_distance
    length = float(rim_distance.max())
    across = np.hypot(x[:, 0], x[:, 1])
    outward = x[:, :2] / np.where(across > 0.0, across, 1.0)[:, None]

    def shape(height: float) -> Array:
        edge = shell.arc_to(height)
        flat = rim_distance > abs(edge)
        radius, z = shell.along(np.where(flat, edge, np.copysign(rim_distance, edge)))
        radius = np.where(flat, radius * (length - rim_distance) / (length - abs(edge)), radius)
        result = np.column_stack([radius[:, None] * outward, np.where(flat, height, z)])
        return np.where(model.free[:, None], result, model.clamped)

    least_height, most_height = ((1.0 - CLOSEST) * height for height in shell.poles)
    least, largest = model.volume(shape(least_height)), model.volume(shape(most_height))
    if not least < volume < largest:
        raise ArithmeticError(
            f"settling: a grid of {len(x)} nodes holds from {least:.4g} to {largest:.4g} m^3 of "
            f"liquid, got {volume:.4g}. Take a finer grid, or a fill fraction nearer to one half."
        )
    return shape(brentq(lambda h: model.volume(shape(h)) - volume, least_height, most_height))
