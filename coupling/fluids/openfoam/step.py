"""The time step of a diaphragm on a flow by OpenFOAM, from its start to its end."""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from pathlib import Path

import meshio
import numpy as np

from coupling.finite_volume.coarsening import coarser_for
from coupling.finite_volume.mesh import half_ball
from coupling.fluids.model import Record
from coupling.fluids.openfoam.flow import OpenFoamFlow
from coupling.fluids.sampled import flow_metrics
from coupling.foam.installation import find_openfoam
from coupling.interface.free_patch import FreePatch
from coupling.interface.liquid_shape import liquid_cg
from coupling.interface.sheet_distance import distance_to_sheet
from coupling.ports import (
    AnyArray,
    Array,
    FlowSample,
    HydrostaticLoad,
    LiquidSample,
    StepReport,
    Structure,
)
from coupling.scene.scene import Scene
from coupling.schemes import SCHEMES
from coupling.step.convergence import Convergence
from coupling.step.coupled import CoupledStep

_log = logging.getLogger(__name__)


def flow_of(scene: Scene, folder: Path, cloth: Structure) -> tuple[OpenFoamFlow, FreePatch]:
    """The flow below the settled ``cloth``, not yet started, and its map to the cloth."""
    shell, mesh = scene.tank.shell, half_ball(*scene.half_ball)
    mapping = FreePatch(
        mesh,
        cloth,
        shell=shell,
        moulded=scene.mould.directions(cloth.reference),
        stretch=scene.mould.length / (0.5 * math.pi * shell.size),
    )
    flow = OpenFoamFlow(
        folder,
        mesh,
        openfoam=find_openfoam(
            scene.openfoam.command,
            keep_alive=scene.openfoam.keep_alive,
            processors=scene.openfoam.processors,
        ),
        shell=shell,
        density=scene.liquid.density,
        viscosity=scene.liquid.viscosity,
        timeout=scene.openfoam.timeout,
        coarser=coarser_for(mesh, len(cloth.reference)),
    )
    return flow, mapping


def start_flow(flow: OpenFoamFlow, mapping: FreePatch, scene: Scene, cloth: Structure) -> None:
    """Put the flow at rest below the settled ``cloth``, whose surface is left beside its mesh."""
    at_rest = mapping.begin_step(cloth.state, 0.0, cloth.state.position)
    flow.start(at_rest.to_flow(cloth.state.position), at_rest.shell, scene.liquid_volume)
    surface = flow.case.folder / "constant" / "triSurface" / "diaphragm.stl"
    surface.parent.mkdir()
    triangles = [("triangle", cloth.triangles)]
    meshio.write(surface, meshio.Mesh(cloth.state.position, triangles), binary=True)


class OpenFoamStep:
    """The coupled step of ``scene``'s settled ``cloth`` with its flow, whose case is in ``folder``.

    ``record``: see ``FluidModel.time_step``. All else as in ``TimeStep``.
    """

    def __init__(self, scene: Scene, cloth: Structure, folder: Path, record: Record) -> None:
        self.scene, self.cloth = scene, cloth
        self.flow, self.mapping = flow_of(scene, folder, cloth)
        self.solver: str | None = self.flow.case.solver
        _log.info("flow solver: %s", self.solver)
        kind = SCHEMES[scene.coupling.scheme]
        self.coupled = CoupledStep(
            cloth, self.flow, self.mapping, kind.of(scene.coupling),
            takes_inertia=kind.takes_inertia,
            convergence=Convergence(
                tolerance=scene.coupling.tolerance,
                acceleration=float(np.linalg.norm(scene.gravity)),
            ),
            max_iterations=scene.coupling.max_iterations, record=record,
        )  # fmt: skip

    @property
    def halvable(self) -> bool:
        """The stock solver, restarted, cannot take steps of uneven lengths."""
        return self.flow.case.uneven_steps

    def start(self) -> None:
        """Put the liquid at rest below the settled diaphragm."""
        start_flow(self.flow, self.mapping, self.scene, self.cloth)

    def attempt(self, time: float, dt: float, load: HydrostaticLoad) -> bool:
        """Solve a step of ``dt`` [s] by coupling iterations."""
        return self.coupled.attempt(time, dt, load)

    def accept(self) -> None:
        """Commit the last attempt."""
        self.coupled.accept()

    def report(self) -> StepReport:
        """What was accepted since this was last asked."""
        return self.coupled.report()

    def seconds(self) -> dict[str, float]:
        """Wall time since this was last asked, by part."""
        return self.coupled.seconds()

    def metrics(self, sample: LiquidSample | None) -> dict[str, float]:
        """Scalars of liquid and mesh."""
        assert sample is None or isinstance(sample, FlowSample)
        state, flow, shell = self.cloth.state, self.flow, self.scene.tank.shell
        triangles = self.cloth.triangles
        below = liquid_cg(state.position, triangles, shell, state.volume)
        inside = flow.points[~flow.mesh.rim]
        away = distance_to_sheet(inside, state.position, triangles)
        mesh = {
            "non_orthogonality_max": flow.non_orthogonality_max,
            "wall_distance": flow.wall_distance,
            "patch_distance": float(np.sqrt(np.mean(away**2))),
            "mesh_cg_offset": float(np.linalg.norm(flow.liquid_cg - below)),
        }
        return flow_metrics(sample, mesh)

    def to_nodes(self, values: Array) -> Array:
        """Values on the faces of the flow's patch (F, k), at the diaphragm's nodes (n, k)."""
        return self.mapping.to_nodes(values)

    def write_fields(self) -> None:
        """Leave U, p*/rho and the points as committed, where the scene asks for them."""
        if self.scene.openfoam.write_fields:
            self.flow.write_fields()

    def save(self) -> dict[str, dict[str, AnyArray]]:
        """The flow, the scheme's and the coupling's memory."""
        return {
            "flow": self.flow.save(),
            "scheme": dict(self.coupled.scheme.save()),
            "coupled": dict(self.coupled.save()),
        }

    def restore(self, saved: Mapping[str, Mapping[str, AnyArray]]) -> None:
        """The reverse of ``save``, in place of ``start``."""
        self.flow.restore(saved["flow"])
        self.coupled.scheme.restore(saved.get("scheme", {}))
        self.coupled.restore(saved.get("coupled", {}))

    def close(self) -> int | None:
        """End the solver; the size of the case where the scene keeps its fields."""
        self.flow.close()
        return self.flow.case.size if self.scene.openfoam.write_fields else None
