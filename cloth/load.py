"""What the diaphragm needs to know of the liquid, and its choice of solver settings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from cloth.arrays import Array


class Turn(Protocol):
    """How the axes of shell and rim, in which positions are given, turn in a step.

    A vector x in them is Q x in those at the step's end. The sheet's inertia is that of axes that
    do not turn; friction, damping and the rubber see its motion in the shell's.
    """

    @property
    def last(self) -> Array:
        """Q (3, 3) from the axes at the step's start."""

    @property
    def before(self) -> Array:
        """Q (3, 3) from the axes at the start of the step before."""


class Rotor(Protocol):
    """How a free tank turns in a step, about the attitude that the step presumes.

    All in the tank's axes there; theta [rad] is the rotation vector of what is found beyond it.
    """

    @property
    def history(self) -> Array:
        """R^T R~ S (3, 3) [kg m^2], R~ the attitude without acceleration, S = int x x^T dm."""

    @property
    def stiffness(self) -> Array:
        """By how much theta lowers ``torque`` (3, 3) [N m]."""

    @property
    def torque(self) -> Array:
        """On the tank by all but its contents, and by p* on the shell as known (3,) [N m]."""

    @property
    def walls(self) -> Array | None:
        """C (r, 3) [kg^(1/2) m]: what the turning shell adds to B v, per rad/s; None for none."""


class Recoil(Protocol):
    """How a free tank gives way to what it contains (``cloth.recoil``)."""

    @property
    def compliance(self) -> Array:
        """1/M (3, 3) [1/kg] of tank and contents, with what holds the tank taken into it."""

    @property
    def density(self) -> float:
        """Of the liquid whose motion in the tank the tank feels [kg/m^3]; 0 for none."""

    @property
    def below_rim(self) -> Array:
        """int x dV (3,) [m^4] over the shell's inside below the rim."""

    @property
    def prediction(self) -> Array:
        """Q~ (3,) [kg m]: the contents' first moment at the step's end, if not accelerated."""

    @property
    def rotor(self) -> Rotor | None:
        """How it turns; None of a tank that is held against turning."""


class Load(Protocol):
    """The liquid's pressure p = datum + density * body_force . x, towards the gas.

    ``density`` [kg/m^3]; ``body_force`` (3,) [m/s^2]; with ``volume`` [m^3] the datum is that
    volume's multiplier, otherwise ``datum`` [Pa] is given.
    """

    @property
    def density(self) -> float:
        """Density of the liquid [kg/m^3]."""

    @property
    def body_force(self) -> Array:
        """Gravity less the tank's acceleration (3,) [m/s^2], in the axes of the step's end."""

    @property
    def volume(self) -> float | None:
        """Volume of the liquid [m^3], where it is a constraint."""

    @property
    def datum(self) -> float | None:
        """Given pressure at the tank's centre [Pa], where the volume is free."""

    @property
    def turn(self) -> Turn | None:
        """How the tank turns in the step, None where it does not."""

    @property
    def recoil(self) -> Recoil | None:
        """Of a free tank, whose acceleration is ``body_force``'s without it; None of a held one."""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Inner iteration of a step, and the sheet's damping.

    ``tolerance`` [-]: the rms displacement over the sheet's size L that is left when it stops, as
    the contraction of its last iterations has it, and less in a step that moves the sheet by little
    (``cloth.iteration.STEPS`` of its own displacement and ``step_scale``); 0 for a fixed number of
    ``iterations``, which otherwise bounds it. ``penalty`` k [N/m] of the stretch, None for
    ``penalty_of`` the step; ``shell_weight`` [-]: the shell's penalty at a node of mean mass, over
    k; ``relaxation`` r [-], 1 to 1.85. ``bending_damping`` tau_b [s]; ``drag`` alpha [1/s], on the
    tangential velocity alone, per cloth mass. ``stretch_damping`` tau [s] of ``cloth.viscous``;
    ``shell_friction`` and ``self_friction`` [-], Coulomb's coefficients on the shell and on itself.
    """

    tolerance: float = 1e-5
    iterations: int = 1000
    penalty: float | None = None
    shell_weight: float = 0.15
    relaxation: float = 1.7
    bending_damping: float = 1.0
    drag: float = 100.0
    stretch_damping: float = 0.0
    shell_friction: float = 0.0
    self_friction: float = 0.0


def pressure_scale(load: Load, size: float) -> float:
    """Return P [Pa], rho |b| L with the sheet's ``size`` L [m], or a given datum where larger."""
    hydrostatic = load.density * float(np.linalg.norm(load.body_force)) * size
    return max(hydrostatic, abs(load.datum or 0.0))


def step_scale(load: Load, *, size: float, areal_density: float, dt: float) -> float:
    """Return the displacement [m] that the whole load would cause in a step of ``dt`` [s].

    dt^2 P/(rho L + m) with the ``pressure_scale`` P over the sheet's ``size`` L [m] and its
    ``areal_density`` m [kg/m^2]; |b| dt^2 where the liquid is much heavier than the sheet. An error
    of a part of that changes accelerations by about this part of |b|, in steps of any length.
    """
    return pressure_scale(load, size) * dt**2 / (load.density * size + areal_density)


def penalty_of(load: Load, *, size: float, inertia: float, compressive: float = 0.0) -> float:
    """Return the penalty k [N/m], in proportion to what a step has to hold.

    The larger of the pressure's tension, P L with the ``pressure_scale`` P over the sheet's
    ``size`` L [m], of its ``inertia`` [N/m], rho_d t L^2/b^2 with the step's time b, and of its
    ``compressive`` stiffness [N/m]: a compressed triangle may turn aside, so its energy is not
    convex, and with a lower penalty the iteration does not converge. In steps of
    sqrt(2), so that a shaken tank needs few different matrices.
    """
    ratio = max(pressure_scale(load, size) * size, compressive) / inertia
    if not (math.isfinite(ratio) and ratio > 1.0):
        return inertia
    return float(inertia * 2.0 ** (0.5 * math.ceil(2.0 * math.log2(ratio))))
