"""What is fixed while a flow's step is solved over and over, and what a solve has found."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from coupling.finite_volume.mesh_shape import MeshShape
from coupling.fluids.openfoam.wall_motion import WallMotion
from coupling.ports import Array, Cause, StepFailed, Turn


@dataclass(frozen=True, kw_only=True)
class FlowSettings:
    """``closure``: share of the liquid's volume that a solver call may miss, as OpenFOAM sums it.

    Above the rounding of some thousand swept volumes; a missing volume that is no rounding makes
    OpenFOAM's pressure equation insoluble. It is a check and changes no result.
    """

    closure: float = 1e-12


@dataclass(frozen=True, kw_only=True)
class FlowStep:
    """A step of the flow.

    ``start`` and ``end`` [s] are as the case names its folders, ``dt`` [s] is between them;
    ``previous_dt`` [s] is the length of the step before, 0 in a run's first. ``turn``: how the
    tank turns, None where it does not.
    """

    start: float
    end: float
    dt: float
    previous_dt: float
    turn: Turn | None = None

    def in_case(self, vectors: Array) -> Array:
        """Vectors (n, 3) at the step's end, in the axes of the case, which do not turn."""
        return vectors if self.turn is None else np.asarray(vectors @ self.turn.attitude.T)

    def in_tank(self, vectors: Array) -> Array:
        """The reverse of ``in_case``."""
        return vectors if self.turn is None else np.asarray(vectors @ self.turn.attitude)

    @property
    def moment(self) -> str:
        """When the step ends, as messages have it."""
        return f"t = {self.end:.6g} s"

    def refuse_open(self, swept: Array, volume: float, settings: FlowSettings) -> None:
        """Raise ``StepFailed`` where ``swept`` (B,) [m^3] do not keep the ``volume`` [m^3]."""
        missed = abs(swept.sum()) / volume
        if missed > settings.closure:
            why = f"the interface changes the liquid's volume by {missed:.1e} of it"
            raise StepFailed(f"{self.moment}: {why}.", cause=Cause.MESH)


@dataclass(frozen=True, kw_only=True)
class FlowSolution:
    """What a solve has found: ``velocity`` (c, 3) [m/s] of the cells, ``wall_pressure`` (B,) [Pa].

    ``walls``: how they move; ``turned``: what p* does on a shell that turns [W].
    """

    velocity: Array
    wall_pressure: Array
    walls: WallMotion
    turned: float = 0.0

    @classmethod
    def of(
        cls, step: FlowStep, velocity: Array, pressure: Array, walls: WallMotion, shape: MeshShape
    ) -> FlowSolution:
        """That of a ``step`` whose mesh ends at ``shape``, with ``pressure`` (B,) [Pa] on walls."""
        turned, count = 0.0, len(pressure)
        if step.turn is not None:
            shell = slice(len(walls.flux), None)
            moved = step.turn.velocity(shape.geometry.face_centre[-count:])[shell]
            area = shape.geometry.face_area[-count:][shell]
            turned = float(np.einsum("f,fx,fx->", pressure[shell], moved, area))
        return cls(velocity=velocity, wall_pressure=pressure, walls=walls, turned=turned)

    @property
    def face_pressure(self) -> Array:
        """p* (F,) [Pa] on the diaphragm's faces."""
        return self.wall_pressure[: len(self.walls.flux)]

    @property
    def power(self) -> float:
        """What p* does on the diaphragm, and on a shell that turns [W]."""
        return float(self.face_pressure @ self.walls.flux) + self.turned
