"""What the parts of a coupled run promise each other.

Data flows one way: scene -> structure | liquid -> coupled step -> results. Every seam stands here,
so that a participant, a fluid or a scheme can be replaced without touching the others.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int64]
AnyArray = NDArray[Any]


class Cause(Enum):
    """What made a run fail, where what helps depends on its scene: ``mends`` knows that."""

    COUPLING = "the coupling diverges"
    MESH = "no mesh of the liquid is valid"
    FLOW = "the flow diverges"
    SHEET = "the diaphragm's inner iteration diverges"


class RunFailed(Exception):  # noqa: N818 - named for what a user reads
    """A run that cannot go on; the message says when and what, and the mend unless it has a cause.

    ``cause``: the mend is ``mends.mend``'s, which knows the scene.
    """

    def __init__(self, message: str = "", *, cause: Cause | None = None) -> None:
        super().__init__(message)
        self.cause = cause


class StepFailed(RunFailed):
    """A step that may succeed in parts: both sides stand where it began."""


@dataclass(frozen=True, kw_only=True)
class HydrostaticLoad:
    """The part of the liquid's pressure that needs no flow: p = datum + density * body_force . x.

    ``density`` [kg/m^3]; ``body_force`` (3,) [m/s^2] is gravity less the tank's acceleration.
    With ``volume`` [m^3] the liquid's volume is a constraint and the datum its multiplier;
    with ``datum`` [Pa] instead the datum is given and the volume goes where it likes.
    """

    density: float
    body_force: Array
    volume: float | None = None
    datum: float | None = None


class Shell(Protocol):
    """The tank's rigid shell, a closed surface of revolution about z, and its inside.

    The origin is the middle of the circle in the plane z = 0 on which the diaphragm is clamped, the
    rim; every point of the shell is seen from it. Points are (n, 3) [m].
    """

    @property
    def size(self) -> float:
        """Radius [m] of the rim's circle, over which lengths are taken."""

    @property
    def poles(self) -> tuple[float, float]:
        """Heights [m] of the lower and the upper pole."""

    @property
    def volume(self) -> float:
        """Of the whole inside [m^3]."""

    def gap(self, x: Array) -> Array:
        """Distance (n,) [m] of ``x`` (n, 3) from the shell, below 0 outside."""

    def project(self, x: Array) -> Array:
        """The shell's nearest points (n, 3) to ``x`` (n, 3)."""

    def confine(self, x: Array, depth: Array | float = 0.0) -> Array:
        """``x`` (n, 3), what lies less than ``depth`` (n,) sizes inside moved to there."""

    def on_rays(self, directions: Array) -> Array:
        """Where rays from the origin in ``directions`` (n, 3), of length 1, meet it (n, 3) [m]."""

    def scaled(self, factor: float) -> Shell:
        """The shell ``factor`` times as large, about the origin."""

    def volume_below(self, height: float) -> float:
        """Volume [m^3] inside, below the plane z = ``height`` [m]."""

    def moment_below(self, height: float) -> float:
        """int z dV [m^4] over the inside below the plane z = ``height`` [m]."""

    def level_of(self, volume: float, up: Array) -> float:
        """Height [m] above the origin, along ``up`` (3,), of the surface of a level ``volume``."""

    def along(self, arc: Array) -> tuple[Array, Array]:
        """Radius and height (n,) [m] of the meridian ``arc`` (n,) [m] above the rim, along it."""

    def arc_to(self, height: float) -> float:
        """The reverse of ``along``: arc length [m] from the rim up to ``height`` [m]."""

    def quadrature(self, degree: int, height: float = 0.0) -> tuple[Array, Array]:
        """Points (n, 3) [m] below z = ``height`` [m] and their outward area vectors (n, 3) [m^2].

        For products of two polynomials of ``degree``, one times the normal.
        """


class StructureState(Protocol):
    """Where the diaphragm stands after a step (arrays are copies)."""

    @property
    def position(self) -> Array:
        """Nodes (n, 3) [m]."""

    @property
    def velocity(self) -> Array:
        """Of the nodes (n, 3) [m/s]."""

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
    def shell_slip(self) -> Array:
        """Way that every node has slid on the shell so far (n,) [m]."""

    @property
    def self_slip(self) -> Array:
        """Way that every node has slid on another part of the sheet so far (n,) [m]."""


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
    walls, relative to them. ``pressure_work`` [J]: of p* there, by the trapezoidal rule.
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
    miss, over the cells' volumes; ``non_orthogonality_max`` [deg]; ``wall_distance`` [m] of the
    centres of the cells at the walls, the mean over their area.
    """

    volume: float
    volume_error: float
    liquid_cg: Array
    continuity_error: float
    non_orthogonality_max: float
    wall_distance: float


class LiquidInertia(Protocol):
    """A liquid's inertia M_a = B^T B on its interface, at one shape of it."""

    @property
    def rows(self) -> Array:
        """B (r, p, 3) [kg^(1/2)] on the interface's points, without uniform pressures."""

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
        self, time: float, dt: float, *, shell: Array | None = None, start: Array | None = None
    ) -> None:
        """Start a step of ``dt`` from the committed fields at ``time`` [s].

        ``shell`` (s, 3) [m]: where the shell's points end it, None where they stay; ``start``
        (p, 3) [m]: where the interface, at rest, has slid to, None where it has not.
        """

    def close_volume(self, points: Array, shell: Array | None = None) -> Array:
        """The nearest interface (p, 3) that encloses the liquid's volume exactly.

        With the shell's points at ``shell`` (s, 3) [m], by default those of the step.
        """

    def solve(self, points: Array) -> Array:
        """p* (F,) [Pa] on the faces when the interface ends the step at ``points`` (closed)."""

    def liquid_inertia(self, points: Array) -> LiquidInertia:
        """The liquid's inertia at this step's end, expected at ``points`` (p, 3) [m]."""

    def inertial_pressure(self, points: Array) -> Array:
        """p* (F,) [Pa] of the inertia at ``points`` (closed); ``solve`` follows before the end."""

    def accept_step(self) -> FlowSample:
        """Commit the last solve."""

    def save(self) -> dict[str, AnyArray]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """The reverse of ``save``."""


@dataclass(frozen=True, kw_only=True)
class StepReport:
    """What the steps took that were accepted since the last report, as one step.

    ``iterations`` of all parts and tries; ``residual``: relative, the largest of the parts;
    ``converged``: whether each part's coupling did; ``samples``: a moving liquid's at the end of
    each part, none of a liquid without a flow. ``volume_error``: relative, the largest of the
    parts, as the flow's mesh has it; None where the diaphragm alone bounds the liquid.
    """

    iterations: int
    residual: float
    converged: bool
    samples: tuple[LiquidSample, ...]
    volume_error: float | None = None

    @property
    def sample(self) -> LiquidSample | None:
        """That of the end, with the work of all parts; None without a flow."""
        if not self.samples:
            return None
        work = sum(sample.pressure_work for sample in self.samples)
        return replace(self.samples[-1], pressure_work=work)


AT_REST = StepReport(iterations=0, residual=0.0, converged=True, samples=())  # before any step


class TimeStep(Protocol):
    """One time step of the diaphragm with its liquid, able to be tried again with a shorter one.

    ``solver``: name of the flow solver, None where none runs; ``halvable``: whether a step can be
    taken in parts.
    """

    solver: str | None

    @property
    def halvable(self) -> bool:
        """Whether a step that does not converge can be taken again as two of half its length."""

    def start(self) -> None:
        """Put the liquid at rest below the settled diaphragm."""

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step from ``time`` to ``time + dt`` [s]; whether it is good enough.

        Raises ArithmeticError or ``StepFailed``; both sides then stand where it began.
        """

    def accept(self) -> None:
        """Commit the last attempt."""

    def report(self) -> StepReport:
        """What was accepted since this was last asked."""

    def seconds(self) -> dict[str, float]:
        """Wall time spent since this was last asked, by part: structure, fluid, mapping."""

    def metrics(self, sample: LiquidSample | None) -> dict[str, float]:
        """Scalars of the committed state for the results; ``sample`` is None before any step."""

    def to_nodes(self, values: Array) -> Array:
        """``values`` (F,) on a sample's faces, at the diaphragm's nodes (n,)."""

    def write_fields(self) -> None:
        """Leave the flow's fields as committed in files, where the scene asks for them."""

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """Everything ``restore`` needs, beside the diaphragm, by name of the checkpoint's group."""

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]]) -> None:
        """The reverse of ``save``, in place of ``start``; the diaphragm has been restored."""

    def close(self) -> int | None:
        """End the flow's solver; bytes of the fields that it leaves, None where it leaves none."""


class SchemeSettings(Protocol):
    """What a scene says of its coupling scheme."""

    @property
    def relaxation(self) -> float:
        """The first relaxation of a step, in (0, 1]."""

    @property
    def reuse(self) -> int:
        """Number of former steps whose columns are used."""


class Scheme(Protocol):
    """A coupling scheme finds x with S(F(x)) = x; it knows interface vectors only.

    ``takes_inertia``: whether the structure carries the liquid's inertia in its own step, a Robin
    condition; ``typical_iterations`` of a step in violent sway, for the cost foreseen.
    """

    takes_inertia: ClassVar[bool]
    typical_iterations: ClassVar[float]

    @classmethod
    def of(cls, settings: SchemeSettings) -> Scheme:
        """The scheme with a scene's ``settings``."""

    def begin_step(self) -> None:
        """Forget what holds within one step only."""

    def update(self, x: Array, residual: Array) -> Array:
        """The next x (k,) from x (k,) and the residual S(F(x)) - x (k,)."""

    def accept_step(self, x: Array, residual: Array) -> None:
        """Keep what later steps may reuse; the step ends at x (k,) with this residual (k,)."""

    def save(self) -> dict[str, Array]:
        """Everything ``restore`` needs."""

    def restore(self, saved: Mapping[str, Array]) -> None:
        """The reverse of ``save``."""
