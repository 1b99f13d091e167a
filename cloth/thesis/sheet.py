"""The thesis' diaphragm behind the face of ours: one step, able to be repeated."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from cloth.arrays import Array
from cloth.energy import SheetEnergy, SheetLosses
from cloth.kernels import principal_strains, volume_and_gradient
from cloth.load import Load
from cloth.material import Diaphragm
from cloth.mesh import rest_gradients
from cloth.shell.sphere import Sphere
from cloth.state import PRESSURES, ClothState, untouched
from cloth.thesis.constants import Constants, constants
from cloth.thesis.grid import ThesisGrid
from cloth.thesis.kernels import advance
from cloth.thesis.reference import SWEEPS_MAX

STEP = 1e-3  # s, the thesis' Table 5


class ThesisSheet:
    """The thesis' square grid and explicit algorithm, to be measured against ``Cloth``.

    ``reference`` (n, 3) [m], ``triangles`` (m, 3), ``fixed`` (n,) are the grid's; ``mass`` (n,)
    [kg], 0 at the rim. Moulded below the equator, where the thesis starts: the liquid lifts it.
    The errata of ``cloth.thesis.reference`` and ``cloth.thesis.constants`` are part of it: what it
    says depends on ``step``, and no limit is approached. Self-contact is not modelled.
    """

    def __init__(
        self,
        *,
        grid: ThesisGrid,
        diaphragm: Diaphragm,
        shell: Sphere,
        strain: float = 0.01,
        step: float = STEP,
        held: bool = False,
    ) -> None:
        """Moulded and at rest.

        ``strain`` [-] the thesis' allowable strain, of which its projections leave up to 1.87 times
        as a mean; ``step`` [s] of its own, as many of which as needed make a step; ``held``: no
        node ever moves.
        """
        self.reference, self.triangles, self.fixed = grid.points, grid.triangles, grid.fixed
        self.held, self.step = held, step
        self.constants: Constants = constants(grid, diaphragm, radius=shell.radius, strain=strain)
        self.mass = self.constants.mass.ravel()
        self.thickness = np.full(len(grid.triangles), diaphragm.thickness)
        self._shape = (grid.size, grid.size, 3)
        self._below_rim = shell.volume_below(0.0)
        self._gradients, _ = rest_gradients(grid.points, grid.triangles)
        self._dt = 0.0
        self._load: Load | None = None
        self._solution: tuple[Array, Array, float] | None = None
        self.iterations = 0
        still = np.zeros_like(grid.points)
        self._memory = self._remembered(grid.points.copy(), still, 0.0, np.zeros(3), 0.0, 0)

    def begin_step(self, dt: float, load: Load, liquid_inertia: Array | None = None) -> None:
        """Start a step of ``dt`` [s] from the committed state.

        Within it the load goes evenly from that of the step before to ``load``, as the thesis
        takes its own at every millisecond. Raises ValueError for a load with a volume, or for
        a ``liquid_inertia``: the thesis has neither a volume constraint nor a liquid with inertia.
        """
        if load.volume is not None or load.datum is None:
            raise ValueError(
                "thesis cloth: the load gives a volume, but the thesis has no volume constraint. "
                'Give the datum alone (model.fluid = "datum"), or take cloth.grid = "rings".'
            )
        if liquid_inertia is not None and len(liquid_inertia) > 0:
            raise ValueError(
                "thesis cloth: its explicit step takes no liquid inertia. "
                'Take cloth.grid = "rings" for a liquid with inertia.'
            )
        self._dt, self._load, self._solution, self.iterations = dt, load, None, 0

    @property
    def previous_step(self) -> float:
        """Length of the step before, 0: explicit steps take the acceleration as constant."""
        return 0.0

    @property
    def converged(self) -> bool:
        """Always true: the thesis promises neither a volume nor a largest strain."""
        return True

    @property
    def turned(self) -> Array:
        """Nothing: its tank is never free."""
        return np.zeros(3)

    @property
    def attitude_found(self) -> bool:
        """Always true."""
        return True

    @property
    def local_error(self) -> float:
        """None: what the thesis' explicit milliseconds add is not estimated."""
        return 0.0

    def _begun(self) -> Load:
        if self._load is None:
            raise RuntimeError("thesis cloth: begin_step comes first.")
        return self._load

    def inertial_prediction(self) -> Array:
        """Return x~ (n, 3) [m], where the committed velocity, a phantom, leads in this step."""
        self._begun()
        return np.asarray(self._memory["position"] + self._dt * self._memory["velocity"])

    def still_position(self) -> Array:
        """Return x^ (n, 3) [m], where the sheet stands: its mean velocity at x is (x - x^) / dt."""
        self._begun()
        return np.asarray(self._memory["position"])

    @property
    def acceleration_scale(self) -> float:
        """The scale dt^2 [s^2] of this step's accelerations."""
        self._begun()
        return self._dt**2

    def solve(self, force: Array, *, alone: bool = False) -> Array:
        """Return positions (n, 3) [m] under the load and nodal ``force`` (n, 3) [N].

        The committed state stays. ``alone`` changes nothing: every solve costs the same.
        Raises ArithmeticError when a projection finds no end, and never returns what is not finite.
        """
        load, m = self._begun(), self._memory
        if self.held:
            return m["position"].copy()
        assert load.datum is not None
        x, v = m["position"].reshape(self._shape).copy(), m["velocity"].reshape(self._shape).copy()
        datum, body = np.array([load.datum] * 2), np.array([load.body_force] * 2)
        if m["steps"][0] > 0.0:
            datum[0], body[0] = m["datum"][0], m["body_force"]
        steps = max(1, math.ceil(self._dt / self.step - 1e-9))
        error, sweeps = advance(
            x, v, self.constants, load.density, datum, body,
            np.ascontiguousarray(force).reshape(self._shape), self._dt / steps, steps,
        )  # fmt: skip
        if sweeps < 0 or not np.isfinite(x).all() or not np.isfinite(v).all():
            raise ArithmeticError(
                f"thesis cloth: the lengths err by {error:.2e} m together after {SWEEPS_MAX} "
                f"sweeps (allowed {self.constants.allowed:.2e} m). Lower time.step below "
                f"{self.step:g} s, or raise cloth.strain_limit."
            )
        self.iterations = sweeps
        self._solution = x.reshape(-1, 3), v.reshape(-1, 3), error
        return self._solution[0].copy()

    def accept_step(self) -> None:
        """Commit the last solve."""
        load = self._begun()
        if self.held:
            return
        if self._solution is None:
            raise RuntimeError("thesis cloth: accept_step needs a solve first.")
        position, velocity, error = self._solution
        pairs = 2 * (self._shape[0] - 1) * (2 * self._shape[0] - 1)
        assert load.datum is not None
        steps = int(self._memory["steps"][0]) + 1
        self._memory = self._remembered(
            position, velocity, load.datum, np.array(load.body_force), error / pairs, steps
        )
        self._load = None

    def _remembered(
        self, position: Array, velocity: Array, datum: float, body: Array, change: float, steps: int
    ) -> dict[str, Array]:
        """All that the next step starts from, and what the triangles say of it."""
        strain, unused = np.empty(len(self.triangles)), np.empty_like(position)
        principal_strains(position, self.triangles, self._gradients, strain)
        cone = volume_and_gradient(position, self.triangles, ~self.fixed, unused)
        return {
            "position": position,
            "velocity": velocity,
            "datum": np.array([datum]),
            "body_force": body,
            "volume": np.array([self._below_rim + cone]),
            "strain": strain,
            "change": np.array([change]),
            "steps": np.array([float(steps)]),
        }

    @property
    def state(self) -> ClothState:
        """The committed state; ``change`` is the mean length error of a pair that is left [m].

        The strain is that of the triangles, in whatever direction it is largest; the thesis'
        own, along the pairs, is smaller. Tension, contact and slips are 0: it knows none. The
        volume counts to the equator.
        """
        m = self._memory
        return ClothState(
            position=m["position"].copy(),
            velocity=m["velocity"].copy(),
            datum_pressure=float(m["datum"][0]),
            volume=float(m["volume"][0]),
            strain=m["strain"].copy(),
            tension=np.zeros_like(m["strain"]),
            contact_force=np.zeros_like(m["position"]),
            **{name: np.zeros(len(self.mass)) for name in PRESSURES},
            **untouched(len(self.mass)),
            change=float(m["change"][0]),
        )

    def energy(self) -> SheetEnergy:
        """Return the kinetic energy alone, of velocities that no projection corrects (erratum 9).

        The thesis' bending stiffness goes with its step (erratum 8): no energy belongs to it.
        """
        speed = np.einsum("id,id->i", self._memory["velocity"], self._memory["velocity"])
        return SheetEnergy(kinetic=0.5 * float(self.mass @ speed))

    def losses(self) -> SheetLosses:
        """Return zero losses: what damping and projections take is not measured."""
        return SheetLosses()

    def save(self) -> dict[str, Array]:
        """Return everything ``restore`` needs to go on bit for bit."""
        return {name: value.copy() for name, value in self._memory.items()}

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Go back to what ``save`` returned; raises ValueError when names or shapes differ."""
        for name, value in self._memory.items():
            found = np.shape(saved[name]) if name in saved else "nothing"
            if found != value.shape:
                raise ValueError(
                    f"thesis cloth checkpoint: {name} needs shape {value.shape}, found {found}. "
                    "Restart with the grid and the resolution of the run that wrote it."
                )
        self._memory = {name: np.array(saved[name], dtype=np.float64) for name in self._memory}
        self._load = None
