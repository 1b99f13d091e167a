"""The lowest free-surface mode of a tank of any shape, its gravity in any direction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from threadpoolctl import threadpool_limits

from cloth.shell.below_plane import Plane, section_samples, wetted_samples
from coupling.fluids.potential.harmonics import harmonics_in
from coupling.fluids.potential.ritz import (
    cone_integral,
    regular_inverse,
    wall_integral,
)
from coupling.fluids.potential.surface_waves import slowest_wave
from coupling.ports import Array

if TYPE_CHECKING:
    from coupling.scene.tank import TankShell

DEGREE = 12
SAMPLES = 1000  # of the meridian, for its lowest point: within 1e-6 of the size of a smooth one


def depth(shell: TankShell, volume: float, up: Array) -> float:
    """Return the depth [m] of a ``volume`` [m^3] at rest in a ``shell``, ``up`` (3,) of any length.

    From the shell's lowest point against ``up`` to the surface.
    """
    up = up / np.linalg.norm(up)
    ends = shell.arc_to(shell.poles[0]), shell.arc_to(shell.poles[1])
    r, z = shell.along(np.linspace(*ends, SAMPLES))
    lowest = float((-np.hypot(up[0], up[1]) * r + up[2] * z).min())
    return shell.level_of(volume, up) - lowest


def lowest_eigenvalue(shell: TankShell, volume: float, up: Array, *, degree: int = DEGREE) -> float:
    """Return omega^2 R/g of the lowest mode of a free surface, R being the rim's radius.

    The Rayleigh quotient over harmonic polynomials, as ``fluids.potential`` has them, on the exact
    shape. From above: within 1e-3 for fill fractions from 0.02 to 0.95 of spheres, pills of 2:1 and
    ellipsoids of 1:2 to 2:1, however they lie; nearer to a full tank by more. Of all modes: in a
    lying pill the lowest is that along its axis, and a motion across it has a higher one.

    Parameters
    ----------
    shell
        The tank.
    volume
        Volume of the liquid [m^3], more than none and less than the tank's.
    up
        Direction against gravity (3,), of any length.
    degree
        Highest degree of the polynomials.

    Returns
    -------
    float
        The eigenvalue [-].
    """
    up = up / np.linalg.norm(up)
    plane = Plane(up=up, level=shell.level_of(volume, up))
    with threadpool_limits(1):
        harmonics = harmonics_in(shell, degree)
        points, size = section_samples(shell.profile, plane, degree)
        values = harmonics.values(points)
        stiffness = wall_integral(harmonics, *wetted_samples(shell.profile, plane, degree))
        stiffness += cone_integral(values, plane.level * size, harmonics)
        inverse = regular_inverse(stiffness[1:, 1:])
        return shell.size * slowest_wave(values[:, 1:], size, inverse)
