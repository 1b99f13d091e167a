"""The sheet over a level liquid: the shape from which its rest is sought."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from cloth.arrays import Array
from cloth.model import ClothModel
from cloth.mould import Mould
from cloth.shell.shell import Shell

PARTS = 400  # of a meridian
CLOSEST = 1e-6  # of the way to a pole, to which the level does not come
SAME = 1e-9  # of the shell's size, within which the mould's mirror image lies on the shell


def level_shape(model: ClothModel, volume: float) -> Array:
    """Return positions (n, 3) [m] of a moulded sheet that lies flat on ``volume`` [m^3] of liquid.

    With gravity along -z. From the clamped rim to its edge the sheet lies as it was moulded, or as
    the mould's mirror image at the rim's plane, each moved into the shell where it is outside;
    where that image is the shell itself, each ring lies as far from the rim along the shell's
    meridian as it is moulded. The rest, moulded nearer to the pole than s_c, is the disc
    r = r_c s/s_c, with s the moulded arc length from the pole and r_c the radius of the edge. No
    length grows where the shell and the mould are convex, since theta/sin(theta) grows and a
    nearest point of a convex body is no farther from another than the points are: it is a state
    without tension. The edge is that of the triangles' own volume. Raises ArithmeticError where the
    triangles cannot hold the volume.
    """
    x, shell = model.mesh.points, model.shell
    mirrored = x * np.array([1.0, 1.0, -1.0])
    even = float(np.abs(shell.gap(mirrored)).max()) <= SAME * shell.size
    shape, ends = _on_shell(model) if even else _on_mould(model, mirrored)
    least, largest = (model.volume(shape((1.0 - CLOSEST) * end)) for end in ends)
    if not least < volume < largest:
        raise ArithmeticError(
            f"settling: a grid of {len(x)} nodes holds from {least:.4g} to {largest:.4g} m^3 of "
            f"liquid, got {volume:.4g}. Take a finer grid, or a fill fraction nearer to one half."
        )
    low, high = ((1.0 - CLOSEST) * end for end in ends)
    return shape(brentq(lambda place: model.volume(shape(place)) - volume, low, high))


def volumes_held(shell: Shell, mould: Mould, whole: float) -> tuple[float, float]:
    """Return the least and the largest volume [m^3] below a sheet of a ``mould`` in the ``shell``.

    As moulded, and as the mould's mirror image, each moved into the shell where it is outside; all
    or nothing where it lies on the shell. ``whole``: the shell's volume [m^3]. By ``PARTS`` of the
    meridian, within their square's inverse.
    """
    r, z = np.array([mould.ring(number, PARTS) for number in range(PARTS + 1)]).T
    held = []
    for side in (z, -z):
        points = np.column_stack([r, np.zeros_like(r), side])
        if np.all(shell.gap(points) <= SAME * shell.size):
            held.append(whole if side[0] > 0.0 else 0.0)
            continue
        across, _, height = shell.confine(points).T
        ends = across[1:] ** 2 + across[1:] * across[:-1] + across[:-1] ** 2
        below = float(ends @ np.diff(height))
        held.append(shell.volume_below(0.0) - math.pi / 3.0 * below)
    return min(held), max(held)


Shape = tuple[Callable[[float], Array], tuple[float, float]]


def _outward(model: ClothModel) -> Array:
    """Horizontal unit vectors (n, 2) from the axis to the moulded nodes."""
    x = model.mesh.points
    across = np.hypot(x[:, 0], x[:, 1])
    return np.asarray(x[:, :2] / np.where(across > 0.0, across, 1.0)[:, None])


def _on_shell(model: ClothModel) -> Shape:
    """Sheets on the shell up to a height [m], as a function of it, and its bounds."""
    shell, rim_distance, outward = model.shell, model.mesh.rim_distance, _outward(model)
    length = float(rim_distance.max())

    def shape(height: float) -> Array:
        edge = shell.arc_to(height)
        flat = rim_distance > abs(edge)
        radius, z = shell.along(np.where(flat, edge, np.copysign(rim_distance, edge)))
        radius = np.where(flat, radius * (length - rim_distance) / (length - abs(edge)), radius)
        result = np.column_stack([radius[:, None] * outward, np.where(flat, height, z)])
        return np.where(model.free[:, None], result, model.clamped)

    return shape, shell.poles


def _on_mould(model: ClothModel, mirrored: Array) -> Shape:
    """Sheets on the mould or on its image up to an arc [m] from the rim, and its bounds.

    Above 0 where the sheet lies above the rim; ``mirrored`` (n, 3) [m] is the mould's image.
    """
    rim_distance, outward = model.mesh.rim_distance, _outward(model)
    length = float(rim_distance.max())
    shell, image, made = model.shell, model.shell.confine(mirrored), model.mesh.points
    if shell.gap(made).min() < -SAME * shell.size:
        made = shell.confine(made)
    sides = (made, image) if model.mesh.points[:, 2].sum() > 0.0 else (image, made)
    arcs, first = np.unique(rim_distance, return_index=True)

    def shape(edge: float) -> Array:
        side = sides[0 if edge >= 0.0 else 1]
        radius = np.hypot(side[:, 0], side[:, 1])
        flat, end = rim_distance > abs(edge), abs(edge)
        widest = float(np.interp(end, arcs, radius[first]))
        height = float(np.interp(end, arcs, side[first, 2]))
        radius = np.where(flat, widest * (length - rim_distance) / (length - end), radius)
        result = np.column_stack([radius[:, None] * outward, np.where(flat, height, side[:, 2])])
        return np.where(model.free[:, None], result, model.clamped)

    return shape, (-length, length)
