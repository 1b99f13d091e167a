"""What is known of a step of the sheet before it is solved."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cloth.arrays import Array
from cloth.kinematics import Kinematics
from cloth.linear import System
from cloth.load import Load, Settings, penalty_of, step_scale
from cloth.model import ClothModel
from cloth.problem import StepProblem, constant_force
from cloth.recoil import TankRecoil
from cloth.rotor import recoil_of
from cloth.state import Memory
from cloth.turning import expected, inertial, relative, rim_inertia
from cloth.viscous import free_strain

SYSTEMS_KEPT = 8  # factorised matrices: step lengths times penalties


class Systems:
    """The matrices of ``model``; the last few are kept, so that a first Euler step costs little."""

    def __init__(self, model: ClothModel) -> None:
        self._model = model
        self._kept: dict[tuple[float, float, Settings], System] = {}

    def of(self, settings: Settings, penalty: float, b: float) -> System:
        """The matrix for a ``penalty`` [N/m] and the time ``b`` [s] of a step."""
        key = (b, penalty, settings)
        if key not in self._kept:
            if len(self._kept) >= SYSTEMS_KEPT:
                self._kept.pop(next(iter(self._kept)))
            self._kept[key] = self._model.system(settings, penalty, b)
        return self._kept[key]


@dataclass(frozen=True, kw_only=True)
class Opening:
    """A step of ``dt`` [s] under ``load``, from the ``memory`` of a sheet.

    ``kin`` in axes that do not turn, ``own`` in the shell's; ``start`` (n, 3) [m]: where its end is
    looked for; ``scale`` [m]: as of ``StepProblem``; ``recoil`` of a free tank.
    """

    model: ClothModel
    memory: Memory
    dt: float
    load: Load
    liquid_inertia: Array | None
    kin: Kinematics
    own: Kinematics
    start: Array
    scale: float
    recoil: TankRecoil | None

    @classmethod
    def of(
        cls,
        model: ClothModel,
        memory: Memory,
        dt: float,
        load: Load,
        liquid_inertia: Array | None,
        *,
        held: bool,
    ) -> Opening:
        """That of a sheet whose nodes do not move at all if ``held``; B as ``Cloth`` has it."""
        kin, rows = inertial(memory, dt, load.turn), liquid_inertia
        if rows is not None and len(rows) == 0:
            rows = None
        start = memory.position
        if not held:
            start = expected(memory, dt, load.turn, model.clamped, model.free)
        areal = model.inertia / model.size**2
        return cls(
            model=model, memory=memory, dt=dt, load=load, liquid_inertia=rows, kin=kin,
            own=kin if load.turn is None else relative(memory, dt), start=start,
            scale=step_scale(load, size=model.size, areal_density=areal, dt=dt),
            recoil=recoil_of(model, load, kin, start, rows),
        )  # fmt: skip

    def problem(self, systems: Systems, settings: Settings) -> StepProblem:
        """What the iteration solves, with one of the ``systems``."""
        model, load, kin, m = self.model, self.load, self.kin, self.memory
        rows, driven = None, None
        if self.liquid_inertia is not None:
            rows = np.where(model.free[None, :, None], self.liquid_inertia / kin.b, 0.0)
            driven = None
            if self.own is not kin:
                driven = rim_inertia(self.liquid_inertia, model, kin)
        penalty = settings.penalty
        if penalty is None:
            inertia, stiffest = model.inertia / kin.b**2, float(model.compressive.max())
            penalty = penalty_of(load, size=model.size, inertia=inertia, compressive=stiffest)
        system = systems.of(settings, penalty, kin.b)
        system.add_mass(rows)
        if self.recoil is not None:
            self.recoil.take_into(system)
        constant = constant_force(model, settings, system, kin, self.own, load, rows, driven)
        return StepProblem(
            model=model, settings=settings, penalty=penalty, system=system, dt=self.dt,
            scale=self.scale, kin=kin, load=load, own=self.own, committed=m.position,
            start=self.start, datum=float(m.datum[0]), tension=m.tension,
            rest=free_strain(m.rubber_strain, settings.stretch_damping / self.dt),
            contact_force=m.contact_force,
            constant_force=constant,
            recoil=self.recoil,
        )  # fmt: skip
