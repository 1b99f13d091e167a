"""What is fixed while a flow's step is solved over and over, and what a solve has found."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.gradients import wall_pressure
from coupling.finite_volume.liquid_inertia import NeumannLaplacian
from coupling.finite_volume.mesh import LiquidMesh
from coupling.ports import Array, Cause, StepFailed


@dataclass(frozen=True, kw_only=True)
class FlowSettings:
    """``closure``: share of the liquid's volume that a solver call may miss, as OpenFOAM sums it.

    Above the rounding of some thousand swept volumes; a missing volume that is no rounding makes
    OpenFOAM's pressure equation insoluble. It is a check and changes no result.
    """

    closure: float = 1e-12


@dataclass(frozen=True, kw_only=True)
class FlowStep:
    """A step of the flow on ``mesh``, of a liquid of ``density`` [kg/m^3].

    ``start`` and ``end`` [s] are as the case names its folders, ``dt`` [s] is between them;
    ``previous_dt`` [s] is the length of the step before, 0 in a run's first. ``sliding`` (B,)
    [m^3/s^2]: rate of the fluxes that boundary points make which slide along, None where they do
    not. ``operator``: of the cells where the step is expected to end, None until that is known.
    """

    mesh: LiquidMesh
    density: float
    start: float
    end: float
    dt: float
    previous_dt: float
    sliding: Array | None
    operator: NeumannLaplacian | None = None

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

    def expected_at(self, geometry: CellGeometry) -> FlowStep:
        """The same step, expected to end with its cells at ``geometry``."""
        return replace(self, operator=NeumannLaplacian(self.mesh, geometry))

    def wall_pressure(self, geometry: CellGeometry, pressure: Array, rate: Array) -> Array:
        """Return p* on the walls, less what points that slide along cause.

        The liquid does not move with those.

        Parameters
        ----------
        geometry
            Where the mesh's cells stand.
        pressure
            p*/rho of the cells (c,) [m^2/s^2].
        rate
            Rate of change of the flux of the diaphragm's faces (F,) [m^3/s^2].

        Returns
        -------
        Array
            p* (B,) [Pa], the diaphragm's faces first, less its area mean there.
        """
        if self.sliding is not None:
            pressure, rate = pressure - self._sliding_pressure, rate - self.sliding[: len(rate)]
        return self.density * wall_pressure(self.mesh, geometry, pressure, rate)

    @cached_property
    def _sliding_pressure(self) -> Array:
        """Of the cells (c,) [m^2/s^2]."""
        assert self.operator is not None
        assert self.sliding is not None
        return self.operator.pressure(self.sliding)

    def inertial_pressure(self, geometry: CellGeometry, rate: Array) -> Array:
        """p* (F,) [Pa] of inertia alone, of cells at ``geometry``; ``rate`` as above."""
        rest = len(self.mesh.faces) - self.mesh.diaphragm.stop
        shell = np.zeros(rest) if self.sliding is None else self.sliding[-rest:]
        cells = NeumannLaplacian(self.mesh, geometry).pressure(np.concatenate([rate, shell]))
        return self.wall_pressure(geometry, cells, rate)[: len(rate)]


@dataclass(frozen=True, kw_only=True)
class FlowSolution:
    """What a solve has found: ``velocity`` (c, 3) [m/s] of the cells, ``wall_pressure`` (B,) [Pa].

    ``swept`` (F,) [m^3]: volumes that the diaphragm's faces have swept.
    """

    velocity: Array
    wall_pressure: Array
    swept: Array

    @property
    def face_pressure(self) -> Array:
        """p* (F,) [Pa] on the diaphragm's faces."""
        return self.wall_pressure[: len(self.swept)]
