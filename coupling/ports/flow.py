"""The liquid's side: what it says of a step, its inertia, and a flow on a mesh."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from coupling.ports.arrays import AnyArray, Array, Ints
from coupling.ports.turn import Turn

if TYPE_CHECKING:
    from scipy.sparse import csr_array


@dataclass(frozen=True, kw_only=True)
class LiquidSample:
    """What a moving liquid says of a step, once accepted.

    ``face_pressure`` (F,) [Pa]: p* on the faces of the diaphragm, area mean removed;
    ``wall_pressure_force`` and ``wall_pressure_moment`` (3,) [N, N m]: of p* on all walls, about
    the tank's centre; ``speed_max`` [m/s] and ``dphi_dt_max`` [m^2/s^2] (see ``fluids.gauge``)
    as in the Bernoulli ratios; ``kinetic_energy`` [J] in the tank's frame.

    ``kinetic_pressure`` (F,) [Pa]: -rho |u|^2/2 on the diaphragm; p* less this is the unsteady
    part, -rho dphi/dt, and whatever vorticity does. ``viscous_traction`` (F,) [Pa]: size of the
    viscous stress on the diaphragm. ``wall_slip`` [m^4/s^2]: int of the squared speed along all
    walls, relative to them. ``pressure_work`` [J]: of p* on the diaphragm, and on
    walls that turn, by the trapezoidal rule.
    """

    face_pressure: Array
    kinetic_pressure: Array
    viscous_traction: Array
    wall_pressure_force: Array
    wall_pressure_moment: Array
    speed_max: float
    dphi_dt_max: float
    kinetic_energy: float
    wall_slip: float
    pressure_work: float


@dataclass(frozen=True, kw_only=True)
class FlowSample(LiquidSample):
    """The same of a liquid on a mesh.

    ``volume`` [m^3] as the flow solver sees it, ``volume_error`` relative to the start;
    ``liquid_cg`` (3,) [m] of the flow's mesh; ``continuity_error``: what the solver's own fluxes
    miss, over the cells' volumes.
    """

    volume: float
    volume_error: float
    liquid_cg: Array
    continuity_error: float


@dataclass(frozen=True, kw_only=True)
class InterfaceMotion:
    """How an interface moves that ends a step at x, by the structure's own implicit formula.

    ``still`` and ``inertial`` (p, 3) [m]: where it would have no velocity, and no acceleration;
    ``b`` [s]: of the formula.
    """

    still: Array
    inertial: Array
    b: float

    def velocity(self, points: Array) -> Array:
        """That (p, 3) [m/s] of an interface that ends the step at ``points`` (p, 3) [m]."""
        return (points - self.still) / self.b

    def acceleration(self, points: Array) -> Array:
        """That (p, 3) [m/s^2] of an interface that ends the step at ``points`` (p, 3) [m]."""
        return (points - self.inertial) / self.b**2

    def shifted(self, shift: Array) -> InterfaceMotion:
        """The same motion ``shift`` (p, 3) [m] away."""
        return InterfaceMotion(still=self.still + shift, inertial=self.inertial + shift, b=self.b)


class LiquidInertia(Protocol):
    """A liquid's inertia M_a = B^T B on its interface, at one shape of it.

    B are combinations of the volumes that some faces sweep, without uniform pressures.
    """

    @property
    def swept(self) -> csr_array:
        """Volumes (k, 3 p) [m^2] that k faces sweep per displacement of the interface's points."""

    def weighted(self, swept: Array) -> Array:
        """B (r, n, 3) [kg^(1/2)] of volumes (k, n, 3) [m^2] that those faces sweep."""

    def force(self, acceleration: Array) -> Array:
        """M_a a (p, 3) [N] of accelerations (p, 3) [m/s^2]: what has to push the liquid."""

    def pressure(self, acceleration: Array) -> Array:
        """The same as pressures (F,) [Pa] on the faces."""


class Flow(Protocol):
    """A liquid that moves: boundary points in, pressure beyond hydrostatics out.

    The interface is the flow's own patch on the diaphragm: ``points`` (p, 3) [m], ``faces``
    (F, 4), seen counter-clockwise from the gas (outside the liquid).
    """

    faces: Ints

    @property
    def points(self) -> Array:
        """The interface (p, 3) [m], as committed."""

    def begin_step(
        self, time: float, dt: float, *, shell: Array | None = None, turn: Turn | None = None
    ) -> None:
        """Start a step of ``dt`` from the committed fields at ``time`` [s].

        ``shell`` (s, 3) [m]: where the shell's points end it, None where they stay. ``turn``: how
        the tank turns; all points are in its axes.
        """

    def close_volume(self, points: Array, shell: Array | None = None) -> Array:
        """The nearest interface (p, 3) that encloses the liquid's volume exactly.

        With the shell's points at ``shell`` (s, 3) [m], by default those of the step.
        """

    def solve(self, points: Array, motion: InterfaceMotion | None = None) -> Array:
        """p* (F,) [Pa] on the faces when the interface ends the step at ``points`` (closed).

        ``motion``: of the diaphragm there, where the points slide along it; without it they move
        as the diaphragm does.
        """

    def liquid_inertia(self, points: Array) -> LiquidInertia:
        """The liquid's inertia at this step's end, expected at ``points`` (p, 3) [m]."""

    def accept_step(self) -> FlowSample:
        """Commit the last solve."""

    def save(self) -> dict[str, AnyArray]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """The reverse of ``save``."""
