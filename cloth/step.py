"""The diaphragm: one implicit step, able to be repeated from the same start."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cloth.arrays import Array
from cloth.committed import committed
from cloth.energy import SheetEnergy, SheetLosses, rubber_at, sheet_energy
from cloth.iteration import iterate
from cloth.kinematics import Kinematics
from cloth.linear import System
from cloth.load import Load, Settings, penalty_of, step_scale
from cloth.material import Diaphragm
from cloth.mesh import Mesh
from cloth.model import ClothModel
from cloth.problem import Solution, StepProblem, constant_force
from cloth.recoil import recoil_in
from cloth.shell.shell import NO_SHELL, Shell
from cloth.state import ClothState, Memory, state_of, untouched
from cloth.turning import carried, expected, inertial, relative, rim_inertia
from cloth.viscous import free_strain

SYSTEMS_KEPT = 8  # factorised matrices: step lengths times penalties


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
        self._systems: dict[tuple[float, float, Settings], System] = {}
        self._kin: Kinematics | None = None
        self._carried: Memory | None = None  # of a sheet that is held in a turning shell
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
        m = self._memory
        self._solution, self._first = None, None
        self._kin = kin = inertial(m, dt, load.turn)
        own = kin if load.turn is None else relative(m, dt)
        self._carried = m if load.turn is None else carried(m, kin, dt)
        if self.held:
            return
        rows, driven = None, None
        if liquid_inertia is not None and len(liquid_inertia) > 0:
            rows = np.where(self.model.free[None, :, None], liquid_inertia / kin.b, 0.0)
            driven = None if own is kin else rim_inertia(liquid_inertia, self.model, kin)
        settings = self.settings if settings is None else settings
        penalty = settings.penalty
        if penalty is None:
            inertia = self.model.inertia / kin.b**2
            stiffest = float(self.model.compressive.max())
            penalty = penalty_of(load, size=self.model.size, inertia=inertia, compressive=stiffest)
        system = self._factorised(settings, penalty, kin.b)
        system.add_mass(rows)
        start = expected(m, dt, load.turn, self.model.clamped, self.model.free)
        recoil = recoil_in(system, self.model, load, b=kin.b, start=start)
        self._problem = StepProblem(
            model=self.model,
            settings=settings,
            penalty=penalty,
            system=system,
            dt=dt,
            scale=step_scale(
                load,
                size=self.model.size,
                areal_density=self.model.inertia / self.model.size**2,
                dt=dt,
            ),
            kin=kin,
            load=load,
            own=own,
            committed=m.position,
            start=start,
            datum=float(m.datum[0]),
            tension=m.tension,
            rest=free_strain(m.rubber_strain, settings.stretch_damping / dt),
            contact_force=m.contact_force,
            constant_force=constant_force(
                self.model, settings, system, kin, own, load, rows, driven
            ),
            recoil=recoil,
        )

    def _factorised(self, settings: Settings, penalty: float, b: float) -> System:
        """The matrix for this b; the last few are kept, so that a first Euler step costs little."""
        key = (b, penalty, settings)
        if key not in self._systems:
            if len(self._systems) >= SYSTEMS_KEPT:
                self._systems.pop(next(iter(self._systems)))
            self._systems[key] = self.model.system(settings, penalty, b)
        return self._systems[key]

    def _begun(self) -> Kinematics:
        if self._kin is None:
            raise RuntimeError("cloth: begin_step comes first.")
        return self._kin

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
            return self._memory.position.copy()
        assert self._problem is not None
        near = bool(self._memory.near[0])
        self._solution = iterate(self._problem, force, self._first, near=near, alone=alone)
        self._first = self._first or self._solution
        return self._solution.position.copy()

    def accept_step(self) -> None:
        """Commit the last solve."""
        self._begun()
        m, s = self._memory, self._solution
        if self.held:
            assert self._carried is not None
            self._memory = self._carried
            return
        if s is None:
            raise RuntimeError("cloth: accept_step needs a solve first.")
        assert self._problem is not None
        self._memory, self._losses = committed(self._problem, s, m)
        self._kin = None

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
        self._kin, self._losses = None, SheetLosses()
