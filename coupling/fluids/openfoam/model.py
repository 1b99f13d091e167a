"""The viscous flow as a fluid model: what it needs, costs and says of itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from coupling.finite_volume.mesh import half_ball
from coupling.finite_volume.mesh_sizes import cells_halved, cells_made
from coupling.fluids.hydrostatic import Hydrostatic, hydrostatic_of
from coupling.fluids.model import (
    CoarserScene,
    ErrorLaw,
    FluidModel,
    Record,
    inertia_wrong,
)
from coupling.ports import IterativeStructure, TimeStep
from coupling.scene.scene import Scene
from coupling.schemes import SCHEMES

ORDER = 1.5  # of the error in the cells' width: ``edt verify momentum`` has 1.6 on 540 and 1216
CELLS, FEWER = 1300, 650  # asked of the mesh in the runs of the error data, and of the coarser one

# CPU seconds on the machine of ``estimate.cost``, fitted to 540, 1216 and 4320 cells; a step's with
# the scheme that takes the liquid's inertia.
_SOLVES = 3.8  # of cloth and flow in a step, over a whole sway; its soft start takes 2
_LATER = 0.8  # a solve of the cloth over that of a step without a flow: it starts nearer
_RESTART = 0.09  # of the solver, for every iteration where it does not stay alive
_CELLS, _GROWTH = 1216, 1.1  # that the next two are for, and how they grow with the cells
_FLOW = 0.045  # an iteration's flow, its forces and its pressures
_MESH = 0.22  # a step's inertia, map and mesh; a quarter of it without the inertia
_START, _START_CELLS = 1.0, 0.4  # the solver's start, of any mesh and of _CELLS
# Bytes of the solver's process, and what both sides keep of a cell.
_PROCESS, _A_CELL = 160e6, 90e3


class OpenFoamModel(FluidModel):
    """Incompressible Navier-Stokes on a mesh that follows the diaphragm: the top of the ladder."""

    name = "openfoam"
    colour, line = "#0072B2", "-"
    has_flow = True
    has_viscosity = True
    error_law = ErrorLaw(law=inertia_wrong)
    coarser_text = "half the cells or fewer"
    kernels_of = "hydrostatic"
    instead = "take model.fluid = 'potential', which needs no mesh and no coupling iteration"
    dissipation_note = (
        "What the liquid loses beyond that goes into vortices, impacts, mesh and step, which this "
        "run does not tell apart."
    )
    pressure_note = (
        "The kinetic part is that of the cells at the diaphragm; the unsteady part is the rest of "
        "p*, with what vorticity does. The viscous stress is the solver’s own."
    )

    def problems(self, scene: Scene) -> list[str]:
        """A restarted solver's steps are even; a tank turns freely where its shell moves no liquid.

        What the flow does on a shell that turns is not known before it is solved.
        """
        found = []
        if scene.time.step_tolerance is not None and not scene.openfoam.keep_alive:
            found.append(
                "time.step_tolerance: takes steps of uneven lengths, which a restarted solver "
                "cannot. Set openfoam.keep_alive = true, or leave it out."
            )
        if scene.carrier.inertia is not None and scene.tank.shape != "sphere":
            found.append(
                f'carrier.inertia: with model.fluid = "{self.name}" a tank turns freely only if it '
                f'is a sphere, got tank.shape = "{scene.tank.shape}". Take model.fluid = '
                '"potential", or leave the inertia out.'
            )
        return found

    def load_model(self, scene: Scene) -> Hydrostatic:
        """The part of the pressure that the flow's equations leave out."""
        return hydrostatic_of(scene)

    def time_step(
        self, scene: Scene, cloth: IterativeStructure, folder: Path, record: Record
    ) -> TimeStep:
        """Return the step that solves diaphragm and flow in turn until they agree."""
        from coupling.fluids.openfoam.step import OpenFoamStep

        return OpenFoamStep(scene, cloth, folder, record)

    def check_installed(self, scene: Scene, *, start: bool) -> None:
        """See that OpenFOAM is here; with ``start`` one step of a tiny flow is solved."""
        chosen = scene.openfoam
        if start:
            from coupling.foam.rehearsal import rehearse

            rehearse(chosen.command, keep_alive=chosen.keep_alive, processors=chosen.processors)
            return
        from coupling.foam.installation import check_installed

        check_installed(chosen.command, keep_alive=chosen.keep_alive, processors=chosen.processors)

    def installed(self) -> Mapping[str, str]:
        """Version and program of OpenFOAM, what else is installed, and the solver built for it."""
        from coupling.foam.installation import find_openfoam
        from coupling.foam.prefixes import OpenFoamMissing, installations, listed

        others = {"OpenFOAMs for --openfoam": listed(installations()) or "none found"}
        try:
            solver = find_openfoam(keep_alive=True)
        except OpenFoamMissing as missing:
            return {self.name: f"not found: {missing}"} | others
        return {
            self.name: f"{solver.version}, {solver.solver}",
            **others,
            "solver that stays alive": str(
                solver.keep_alive
                or "not built: 'edt build-solver' makes runs with a flow faster, and waves last "
                "longer"
            ),
        }

    def step_cost(self, scene: Scene, solve: float) -> float:
        """Return the CPU time [s] of a step: of cloth, flow and, if the scheme takes it, inertia.

        Without the liquid's inertia it is that of the scheme's own number of iterations.
        """
        taken = SCHEMES[scene.coupling.scheme]
        solves = _SOLVES if taken.takes_inertia else taken.typical_iterations
        size = _size(scene) ** _GROWTH
        flow = _FLOW * size + _RESTART * (not _stays_alive(scene))
        mesh = (1.0 if taken.takes_inertia else 0.25) * _MESH * size
        return float(solves * (_LATER * solve + flow) + mesh)

    def start_cost(self, scene: Scene) -> float:
        """Return the CPU time [s] of the solver's start with the scene's mesh."""
        return _START + _START_CELLS * _size(scene)

    def memory(self, scene: Scene) -> float:
        """Return the bytes of RAM of the solver's processes, and of what is kept of the cells."""
        cells = cells_made(*scene.half_ball)
        return scene.openfoam.processors * _PROCESS + _A_CELL * cells

    def cores(self, scene: Scene) -> int:
        """Return the number of processes of the flow solver."""
        return scene.openfoam.processors

    def error_scale(self, scene: Scene) -> float:
        """Return the error of the scene's mesh over that of CELLS."""
        finer = cells_made(CELLS) / cells_made(*scene.half_ball)
        return float(finer ** (ORDER / 3.0))

    def coarser(self, scene: Scene) -> CoarserScene:
        """Return the scene with about half the cells, as near as the meshes come to that."""
        cells = cells_halved(*scene.half_ball)
        section = scene.openfoam.model_copy(update={"cells": cells})
        fewer = cells_made(*scene.half_ball) / cells
        return CoarserScene(
            scene=scene.model_copy(update={"openfoam": section}),
            width=fewer ** (1.0 / 3.0),
            order=ORDER,
        )

    def approximations(self, scene: Scene) -> Mapping[str, CoarserScene]:
        """Return the scene coupled to ten times its tolerance, with which the error goes."""
        looser = scene.coupling.model_copy(update={"tolerance": 10.0 * scene.coupling.tolerance})
        changed = scene.model_copy(update={"coupling": looser})
        return {"looser_coupling": CoarserScene(scene=changed, width=10.0, order=1.0)}

    def size(self, scene: Scene) -> Mapping[str, int]:
        """Return the number of the mesh's cells, by what is counted."""
        return {"cells of the flow's mesh": cells_made(*scene.half_ball)}

    def fields_size(self, scene: Scene) -> float:
        """Return the bytes that p, U and points take at the times of output."""
        if not scene.openfoam.write_fields:
            return 0.0
        mesh = half_ball(*scene.half_ball)
        values = mesh.cells + len(mesh.faces) - mesh.inner_faces  # in the cells and on the walls
        times = -(-scene.time.steps // scene.time.output_every)
        return 8.0 * times * (4 * values + 3 * len(mesh.points))


def grid_error(distance: float) -> float:
    """Error of a run on CELLS, by Richardson's estimate, one on FEWER being ``distance`` off it."""
    wider = (cells_made(CELLS) / cells_made(FEWER)) ** (1.0 / 3.0)
    return float(distance / (wider**ORDER - 1.0))


def _size(scene: Scene) -> float:
    """Cells of the scene's mesh over those of the constants."""
    return cells_made(*scene.half_ball) / _CELLS


def _stays_alive(scene: Scene) -> bool:
    from coupling.foam.solver_cache import built_for_any

    return scene.openfoam.keep_alive and built_for_any()


OPENFOAM = OpenFoamModel()
