"""What the diaphragm needs to know of the liquid, and its choice of solver settings."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from cloth.arrays import Array


class Load(Protocol):
    """The liquid's pressure p = datum + density * body_force . x, towards the gas.

    ``density`` [kg/m^3]; ``body_force`` (3,) [m/s^2]; with ``volume`` [m^3] the datum is that
    volume's multiplier, otherwise ``datum`` [Pa] is given.
    """

    @property
    def density(self) -> float:
        """Of the liquid [kg/m^3]."""

    @property
    def body_force(self) -> Array:
        """Gravity less the tank's acceleration (3,) [m/s^2]."""

    @property
    def volume(self) -> float | None:
        """Of the liquid [m^3], where it is a constraint."""

    @property
    def datum(self) -> float | None:
        """Given pressure at the tank's centre [Pa], where the volume is free."""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Inner iteration of a step.

    ``penalty`` k [N/m] of the strain limit, at least (see ``raised``); ``relaxation`` r [-], 1 to
    1.8; ``contact_weight`` [-], the shell's penalty over m/b^2; ``bending_damping`` tau_b [s];
    ``drag`` alpha [1/s], on the tangential velocity alone, per cloth mass; ``iterations`` always
    done and at most done when a strain is above the limit.
    """

    penalty: float
    relaxation: float
    contact_weight: float
    bending_damping: float
    drag: float
    iterations: int
    iterations_max: int


def raised(settings: Settings, load: Load, *, size: float, inertia: float) -> Settings:
    """``settings`` with the penalty k in proportion to what a step of a sheet has to hold.

    ``size`` L [m] of the sheet. ``inertia`` [N/m] is rho_d t L h/b^2, h the grid's spacing and b
    the step's time: k between the inertia of the sheet's longest and of its shortest waves, or a
    short step creeps and shakes itself. Below half the tension the iteration diverges, far above
    it crawls: a dome carries T = rho |b| L^2/2, above which k is raised by powers of four, so
    that a shaken tank needs few different matrices.
    """
    least = max(settings.penalty, inertia)
    strength = float(np.linalg.norm(load.body_force))
    ratio = 0.5 * load.density * strength * size**2 / least
    if math.isfinite(ratio) and ratio > 1.0:
        least *= 4.0 ** math.ceil(math.log(ratio, 4.0))
    return replace(settings, penalty=least)


DRY = Settings(
    penalty=2000.0,
    relaxation=1.7,
    contact_weight=2.0,
    bending_damping=1.0,
    drag=100.0,
    iterations=10,
    iterations_max=400,
)
WET = Settings(
    penalty=1e4,
    relaxation=1.7,
    contact_weight=3.0,
    bending_damping=1.0,
    drag=100.0,
    iterations=20,
    iterations_max=400,
)
# For the inertia of a smooth potential. A shell that goes by the sheet's own mass, as above, lets
# violent sway at low fill diverge.
WET_LONG_WAVES = replace(WET, contact_weight=30.0)
