"""The diaphragm's side: its load, its state and its steps."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from coupling.ports.arrays import Array, Ints
from coupling.ports.turn import Turn


@dataclass(frozen=True, kw_only=True)
class Rotor:
    """How a free tank turns in a step, about the attitude R that the step presumes.

    ``history`` R^T R~ S (3, 3) [kg m^2], R~ being the attitude without acceleration and S int x x^T
    dm of the tank alone; ``torque`` (3,) [N m] on it by all but its contents, and by p* on the
    shell as far as it is known before the step; ``stiffness`` (3, 3) [N m]: by how much a turn
    beyond R lowers that. ``walls`` C (r, 3) [kg^(1/2) m]: the turning shell's part of the liquid's
    inertia, whose kinetic energy is |B v + C omega|^2/2; None for none. In the tank's axes at R.
    """

    history: Array
    torque: Array
    stiffness: Array
    walls: Array | None = None


@dataclass(frozen=True, kw_only=True)
class Recoil:
    """How a free tank gives way in a step: M (a - a0) = -(Q - Q~)/b^2.

    ``compliance`` 1/M (3, 3) [1/kg] of tank and contents, with springs and dampers taken into it; Q
    [kg m] is the first moment of the sheet and of a liquid of ``density`` [kg/m^3] (0: its motion
    in the tank is not felt), ``prediction`` Q~ [kg m] that of contents which are not accelerated in
    the tank; ``below_rim`` (3,) [m^4]: int x dV over the shell's inside there. ``rotor``: how it
    turns, None of a tank that is held against turning. All in the tank's axes at the step's end.
    """

    compliance: Array
    density: float
    prediction: Array
    below_rim: Array
    rotor: Rotor | None = None


@dataclass(frozen=True, kw_only=True)
class HydrostaticLoad:
    """The part of the liquid's pressure that needs no flow: p = datum + density * body_force . x.

    ``density`` [kg/m^3]; ``body_force`` (3,) [m/s^2] is gravity less the tank's acceleration.
    With ``volume`` [m^3] the liquid's volume is a constraint and the datum its multiplier;
    with ``datum`` [Pa] instead the datum is given and the volume goes where it likes.
    ``turn``: how the tank turns in the step, None where it does not; ``body_force`` is in the
    tank's axes at the step's end. ``recoil`` of a free tank: then ``body_force`` is that of an
    acceleration a0.
    """

    density: float
    body_force: Array
    volume: float | None = None
    datum: float | None = None
    turn: Turn | None = None
    recoil: Recoil | None = None


class StructureState(Protocol):
    """Where the diaphragm stands after a step (arrays are copies)."""

    @property
    def position(self) -> Array:
        """Nodes (n, 3) [m]."""

    @property
    def velocity(self) -> Array:
        """Of the nodes (n, 3) [m/s], in axes that do not turn, which are the tank's just now."""

    @property
    def datum_pressure(self) -> float:
        """p0 [Pa], the volume's multiplier or the given datum."""

    @property
    def volume(self) -> float:
        """Of the liquid [m^3], as the structure's triangles enclose it."""

    @property
    def strain(self) -> Array:
        """Largest principal tensile strain of every triangle (m,)."""


class DiaphragmState(StructureState, Protocol):
    """The same of a rubber sheet, which tears and wears."""

    @property
    def change(self) -> float:
        """Rms displacement [m] that the solver's iteration has left, as estimated."""

    @property
    def tension(self) -> Array:
        """Largest principal tension of every triangle (m,) [N/m]."""

    @property
    def contact_force(self) -> Array:
        """What the nodes exert on the shell and on other parts of the sheet (n, 3) [N]."""

    @property
    def shell_pressure(self) -> Array:
        """Pressure on the shell, per moulded area (n,) [Pa]."""

    @property
    def self_pressure(self) -> Array:
        """Pressure on other parts of the sheet, per moulded area (n,) [Pa]."""

    @property
    def shell_slip(self) -> Array:
        """Way that every node has slid on the shell so far (n,) [m]."""

    @property
    def self_slip(self) -> Array:
        """Way that every node has slid on another part of the sheet so far (n,) [m]."""

    @property
    def shell_work(self) -> Array:
        """Int of the pressure on the shell over that way, so far (n,) [J/m^2]."""

    @property
    def self_work(self) -> Array:
        """The same of the pressure on another part of the sheet (n,) [J/m^2]."""

    @property
    def rub_place(self) -> Array:
        """Where on the shell, the mean weighted by that work; 0 without any (n, 3) [m]."""


class Structure(Protocol):
    """The diaphragm, able to repeat a step from the same start."""

    reference: Array  # (n, 3) [m] moulded shape
    triangles: Ints  # (m, 3), counter-clockwise seen from the gas
    fixed: NDArray[np.bool_]  # (n,) clamped nodes

    def begin_step(
        self, dt: float, load: HydrostaticLoad, liquid_inertia: Array | None = None
    ) -> None:
        """Start a step of ``dt`` [s] from the committed state.

        ``liquid_inertia`` (r, n, 3) [kg^(1/2)]: rows B with M_a = B^T B, held during the step.
        """

    def inertial_prediction(self) -> Array:
        """x~ (n, 3) [m] of this step: its acceleration at x is (x - x~) / acceleration_scale."""

    def still_position(self) -> Array:
        """x^ (n, 3) [m] of this step: its velocity at x is (x - x^) / b, by b^2 as below."""

    @property
    def acceleration_scale(self) -> float:
        """b^2 [s^2] of this step's implicit formula (dt^2 for Euler, (2 dt / 3)^2 for BDF2)."""

    def solve(self, force: Array) -> Array:
        """Position (n, 3) [m] under the load and nodal ``force`` (n, 3) [N].

        The ``liquid_inertia`` of the step is part of the solve. The committed state stays as it
        was: the call can be repeated, and the same force gives the same answer bit for bit.
        """

    def accept_step(self) -> None:
        """Commit the last solve."""

    @property
    def state(self) -> StructureState:
        """The committed state."""

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs to go on bit for bit."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""


class IterativeStructure(Structure, Protocol):
    """A diaphragm whose solve is an iteration of its own."""

    def solve(self, force: Array, *, alone: bool = False) -> Array:
        """See ``Structure``; ``alone``: the step is solved this once."""

    @property
    def converged(self) -> bool:
        """Whether the last solve reached its tolerance."""

    @property
    def local_error(self) -> float:
        """Rms error [m] of the last solve that the step's length adds; 0 where not estimated."""
