"""The diaphragm: one implicit step, able to be repeated from the same start."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cloth.arrays import Array
from cloth.committed import committed
from cloth.energy import SheetEnergy, SheetLosses, rubber_at, sheet_energy
from cloth.iteration import STEPS, iterate
from cloth.kinematics import Kinematics
from cloth.load import Load, Settings
from cloth.material import Diaphragm
from cloth.mesh import Mesh
from cloth.model import ClothModel
from cloth.opening import Opening, Systems
from cloth.problem import Solution, StepProblem
from cloth.recoil import turned_in
from cloth.shell.shell import NO_SHELL, Shell
from cloth.state import ClothState, Memory, state_of, untouched
from cloth.turning import carried


class Cloth:
    """An elastic sheet, free, clamped, or in a rigid shell.

    min 1/2 |x - x~|^2_{(M + M_a)/b^2} + sum_t A_t W(sigma) + bending + sum I(x in the shell)
    minus the work of the pressure, subject to V(x) = V*, by ADMM (Overby et al. 2017) on BDF2. W is
    the stretch's energy (``cloth.reference.limited``).
    ``reference`` (n, 3) [m], ``triangles`` (m, 3), ``fixed`` (n,) are the mesh's; ``mass`` (n,)
    [kg]; ``thickness`` (m,) [m].
    """

    def __init__(
        self,
        *,
        mesh: Mesh,
        diaphragm: Diaphragm,
        shell: Shell = NO_SHELL,
        thickness: Array | None = None,
        position: Array | None = None,
        tensile_stiffness: float | None = None,
        compressive_stiffness: float | None = None,
        self_contact: bool = False,
        clamped_rim: bool = False,
        settings: Settings | None = None,
        held: bool = False,
    ) -> None:
        """At rest as moulded, or at ``position`` (n, 3) [m], where fixed nodes are then held.

        ``shell``: without one the volume is the cone's alone;
        ``thickness`` (m,) [m] of every triangle instead of the diaphragm's; ``tensile_stiffness``
        and ``compressive_stiffness`` [N/m] instead of the rubber's own E t: large for a sheet that
        hardly stretches, small for one that wrinkles below the grid. ``self_contact``: the sheet
        does not pass through itself, its mid-surfaces a thickness apart; it must not do so at the
        start. ``clamped_rim``: fixed nodes of the border hold the moulded slope, and must stand as
        moulded. ``held``: no node ever moves.
        """
        position = mesh.points if position is None else position
        self.reference, self.triangles, self.fixed = mesh.points, mesh.triangles, mesh.fixed
        self.held = held
        self.model = ClothModel(
            mesh=mesh,
            diaphragm=diaphragm,
            thickness=thickness,
            clamped=position,
            shell=shell,
            tensile_stiffness=tensile_stiffness,
            compressive_stiffness=compressive_stiffness,
            self_contact=self_contact,
            clamped_rim=clamped_rim,
        )
        self.mass, self.thickness = self.model.mass, self.model.thickness
        self.settings = Settings() if settings is None else settings
        self._memory = Memory.at_rest(position, len(mesh.triangles), self.model.volume(position))
        self._memory.rubber_strain, _ = rubber_at(self.model, position)
        self._systems = Systems(self.model)
        self._opening: Opening | None = None  # of the step that has begun
        self._carried = self._memory  # after it, of a sheet that is held
        self._turned = np.zeros(3)
        self._losses = SheetLosses()  # in the step that led to the committed state, if known
        self._problem: StepProblem | None = None
        self._first: Solution | None = None
        self._solution: Solution | None = None

    def begin_step(
        self,
        dt: float,
        load: Load,
        liquid_inertia: Array | None = None,
        *,
        settings: Settings | None = None,
    ) -> None:
        """Start a step of ``dt`` [s] from the committed state.

        ``liquid_inertia`` (r, n, 3) [kg^(1/2)]: rows B with M_a = B^T B, held during the step.
        ``settings``: for this step in place of the cloth's own.
        """
        if (load.volume is None) == (load.datum is None):
            raise ValueError("cloth load: give either the volume or the datum, not both.")
        self._solution, self._first = None, None
        self._opening = Opening.of(
            self.model, self._memory, dt, load, liquid_inertia, held=self.held
        )
        self._carried = self._memory
        if load.turn is not None:
            self._carried = carried(self._memory, self._opening.kin, dt)
        if not self.held:
            self._problem = self._opening.problem(self._systems, settings or self.settings)

    def _begun(self) -> Kinematics:
        return self._open.kin

    @property
    def _open(self) -> Opening:
        if self._opening is None:
            raise RuntimeError("cloth: begin_step comes first.")
        return self._opening

    def inertial_prediction(self) -> Array:
        """Return x~ (n, 3) [m]: the acceleration at x is (x - x~) / acceleration_scale."""
        return self._begun().prediction

    def still_position(self) -> Array:
        """Return x^ (n, 3) [m]: the velocity at x is (x - x^) over the root of that scale."""
        return self._begun().position_anchor

    @property
    def acceleration_scale(self) -> float:
        """Scale b^2 [s^2] of this step's accelerations (dt^2 for Euler, (2 dt / 3)^2 for BDF2)."""
        return self._begun().b ** 2

    @property
    def iterations(self) -> int:
        """Inner iterations of the last solve of this step, 0 before the first."""
        return 0 if self._solution is None else self._solution.iterations

    @property
    def converged(self) -> bool:
        """Whether the last solve of this step met its tolerance and kept the volume."""
        return self._solution is None or self._solution.converged

    @property
    def local_error(self) -> float:
        """Rms error [m] that this step's length adds, of the last solve."""
        if self._solution is None:
            return 0.0
        return self._begun().local_error(self._solution.position)

    def solve(self, force: Array, *, alone: bool = False) -> Array:
        """Return positions (n, 3) [m] under the load and nodal ``force`` (n, 3) [N].

        The first solve of a step decides the number of iterations and which parts of the sheet
        touch, and the following ones keep to it, so that the answer is a continuous function of
        ``force``. The committed state stays. ``alone``: the step is solved this once, so that the
        first solve need not go on for the others.
        Raises ArithmeticError when the iteration diverges, and never returns what is not finite.
        """
        self._begun()
        if self.held:
            return self._carry(force)
        assert self._problem is not None
        near = bool(self._memory.near[0])
        self._solution = iterate(self._problem, force, self._first, near=near, alone=alone)
        self._first = self._first or self._solution
        self._turned = self._solution.turned
        return self._solution.position.copy()

    def _carry(self, force: Array) -> Array:
        """Where a sheet that is held stays (n, 3) [m], and how its tank turns with it."""
        step = self._open
        self._turned = turned_in(step.recoil, step.start, force)
        if step.load.turn is not None:
            self._carried = carried(step.memory, step.kin.turned(self._turned), step.dt)
        return step.start.copy()

    @property
    def turned(self) -> Array:
        """Rotation vector (3,) [rad] by which a free tank ends beyond what the step presumes."""
        return self._turned

    @property
    def attitude_found(self) -> bool:
        """Whether that moves the rim by no more than the solve of a sheet at rest may leave."""
        way = self.model.size * float(np.linalg.norm(self._turned))
        return way <= self.settings.tolerance * STEPS * self._open.scale

    def accept_step(self) -> None:
        """Commit the last solve."""
        self._begun()
        m, s = self._memory, self._solution
        if self.held:
            self._memory = self._carried
            return
        if s is None:
            raise RuntimeError("cloth: accept_step needs a solve first.")
        assert self._problem is not None
        self._memory, self._losses = committed(self._problem, s, m)
        self._opening = None

    def halt(self) -> None:
        """Bring the committed state to rest where it is: no velocity, no history, no rub yet."""
        m = self._memory
        for name, nothing in untouched(len(m.position)).items():
            setattr(m, name, nothing)
        still = np.zeros_like(m.velocity)
        m.velocity, m.previous_velocity = still, still
        m.previous_position, m.previous_dt = m.position, np.zeros(1)
        self._losses = SheetLosses()

    @property
    def previous_step(self) -> float:
        """Length [s] of the step that led to the committed state; 0 where the next is Euler's."""
        return float(self._memory.previous_dt[0])

    @property
    def state(self) -> ClothState:
        """The committed state."""
        return state_of(self._memory)

    def energy(self) -> SheetEnergy:
        """Return the energies of the committed state."""
        return sheet_energy(self.model, self._memory)

    def losses(self) -> SheetLosses:
        """Return what was lost in the step accepted last; none before the first."""
        return self._losses

    def save(self) -> dict[str, Array]:
        """Return everything ``restore`` needs to go on bit for bit."""
        return self._memory.save()

    def restore(self, saved: Mapping[str, Array]) -> None:
        """Go back to what ``save`` returned; raises ValueError when names or shapes differ."""
        self._memory = Memory.restored(saved, self._memory)
        self._opening, self._losses = None, SheetLosses()
