"""The wrinkles of the rubber against the grid: which of them it can show."""

from __future__ import annotations

import math

import numpy as np

from coupling.ports import Array
from coupling.scene.diaphragm import Diaphragm
from coupling.scene.numerics import Cloth
from coupling.scene.sections import Liquid

CELLS_A_WAVELENGTH = 10  # from where on a grid carries a wave's bending; a rule, not a bound


def elasto_gravity_wavelength(*, bending_stiffness: float, density: float, gravity: float) -> float:
    """2 pi (kappa/(rho g))^(1/4) [m]: the length of the wrinkles that bending chooses.

    ``bending_stiffness`` kappa [N m], ``density`` [kg/m^3] of the liquid, ``gravity`` [m/s^2]
    (Pocivavsek et al., Science 320 (2008) 912, for a thin sheet on a liquid).
    """
    return float(2.0 * np.pi * (bending_stiffness / (density * gravity)) ** 0.25)


def shortest_wavelength(diaphragm: Diaphragm, liquid: Liquid, gravity: Array) -> float:
    """Elasto-gravity wavelength [m] under ``gravity`` (3,) [m/s^2], where the rubber is thinnest.

    Shaking presses harder than gravity and shortens it, as the fourth root: by 14 % at 1.8 g.
    """
    thinnest, _ = diaphragm.thickness_range
    return elasto_gravity_wavelength(
        bending_stiffness=float(diaphragm.sheet.bending_stiffness_at(np.array(thinnest))),
        density=liquid.density,
        gravity=float(np.linalg.norm(gravity)),
    )


def grid_spacing(length: float, cloth: Cloth) -> float:
    """From ring to ring [m] of a sheet whose moulded meridian has this ``length`` [m]."""
    return length / cloth.rings


def rings_to_resolve(length: float, wavelength: float) -> int:
    """Least rings with ``CELLS_A_WAVELENGTH`` spacings to a ``wavelength`` [m].

    ``length`` [m]: of the sheet's moulded meridian.
    """
    rings = CELLS_A_WAVELENGTH * length / wavelength
    return math.ceil(rings * (1.0 - 1e-12))
