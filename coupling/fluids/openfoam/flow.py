"""Incompressible Navier-Stokes in the moving tank, by OpenFOAM's pimpleFoam.

The flow is solved in the tank's frame, which does not turn, without body force: the body force is a
gradient, so that the pressure found is p*, what hydrostatics leaves out. Every coupling iteration
solves the step anew from the committed fields; its points are all imposed.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from coupling.finite_volume.coarsening import Coarsening
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.geometry import centre_of_gravity
from coupling.finite_volume.gradients import wall_pressure
from coupling.finite_volume.liquid_inertia import LiquidInertia, NeumannLaplacian
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.rates import FluxRate
from coupling.finite_volume.wall import cell_distance, wall_flow
from coupling.fluids.openfoam.flow_step import FlowSettings, FlowSolution, FlowStep
from coupling.fluids.openfoam.sample import flow_sample
from coupling.fluids.openfoam.wall_motion import NO_SLIDE, WallMotion, wall_motion
from coupling.foam.keepalive import case_of
from coupling.foam.kept_times import KeptTimes
from coupling.foam.packed_times import packed, unpack
from coupling.foam.process import OpenFoam
from coupling.ports import AnyArray, Array, Confinement, FlowSample, InterfaceMotion, Ints, Turn


class OpenFoamFlow:
    """The liquid on a mesh, in an OpenFOAM case in ``folder``.

    ``density`` [kg/m^3], ``viscosity`` [m^2/s], ``timeout`` [s] of one solver call; the tank's
    ``shell``. The liquid's inertia is found on the mesh of ``coarser``, by default on its own.
    Nothing is written before ``start`` or ``restore``.
    """

    def __init__(
        self,
        folder: Path,
        mesh: LiquidMesh,
        *,
        openfoam: OpenFoam,
        shell: Confinement,
        density: float,
        viscosity: float,
        timeout: float,
        coarser: Coarsening | None = None,
        settings: FlowSettings | None = None,
    ) -> None:
        self.settings = settings or FlowSettings()
        self._coarser = coarser
        self.mesh = mesh
        self.case = case_of(folder, mesh, openfoam=openfoam, timeout=timeout)
        self.density, self.viscosity = density, viscosity
        self.faces: Ints = mesh.patch_faces
        self._following = FollowingMesh(mesh, shell)
        self._initial = self._following.patch, self._following.shell  # at rest
        self._swept = FluxRate(len(mesh.faces) - mesh.inner_faces)
        self._power = 0.0  # of p* on the diaphragm [W], as committed
        self.time, self._previous_dt = 0.0, 0.0  # the latter of the step before, 0 at the start
        self._step: FlowStep | None = None
        self._solution: FlowSolution | None = None
        self._times = KeptTimes(self.case)

    @property
    def points(self) -> Array:
        """The interface (p, 3) [m], as committed."""
        return self._following.patch

    @property
    def mesh_points(self) -> Array:
        """All points (P, 3) [m], as committed."""
        return self._following.points

    @property
    def volume(self) -> float:
        """Volume [m^3] of the liquid at the start."""
        return self._following.volume

    @property
    def non_orthogonality_max(self) -> float:
        """Largest non-orthogonality [deg] of the committed mesh."""
        return self._following.non_orthogonality_max

    @property
    def wall_distance(self) -> float:
        """Mean distance [m] of the wall cells' centres from the walls of the committed mesh."""
        return cell_distance(self.mesh, self._following.geometry)

    @property
    def liquid_cg(self) -> Array:
        """Centre of gravity (3,) [m] of the committed mesh."""
        return centre_of_gravity(self._following.geometry)

    def start(self, patch: Array, shell: Array, volume: float) -> None:
        """Write the case for a liquid at rest below the diaphragm.

        A common factor takes the shell's points off its surface until the mesh, an inscribed
        polyhedron, holds the liquid's volume.

        Parameters
        ----------
        patch
            The interface (p, 3) [m], its rim on the shell.
        shell
            The shell's other points (s, 3) [m].
        volume
            Volume of the liquid [m^3].
        """
        self._place(patch, self._following.raised(shell, patch, volume))
        self.case.create(self.mesh_points, viscosity=self.viscosity)

    def _place(self, patch: Array, shell: Array) -> None:
        """The state of a liquid at rest."""
        self.time, self._previous_dt = 0.0, 0.0
        self._initial = patch, shell
        self._following.place(patch, shell)
        self._swept = FluxRate(len(self.mesh.faces) - self.mesh.inner_faces)
        self._power = 0.0

    def begin_step(
        self, time: float, dt: float, *, shell: Array | None = None, turn: Turn | None = None
    ) -> None:
        """Start a step of ``dt`` [s] from the committed fields at ``time`` [s].

        ``shell`` (s, 3) [m]: where the shell's points end it, None where they stay. Points are in
        the tank's axes; where that has a ``turn``, the case's are in axes that do not.
        """
        self._following.begin_step(shell, turn)
        # As the case names its folders: the next step starts where this ends, digit for digit.
        self.time = round(time, 11)
        self._step = FlowStep(
            start=self.time, end=round(time + dt, 11), dt=dt, previous_dt=self._previous_dt,
            turn=turn,
        )  # fmt: skip

    @property
    def step(self) -> FlowStep:
        """The step that has begun."""
        if self._step is None:
            raise RuntimeError("flow: begin_step comes first.")
        return self._step

    def close_volume(self, points: Array, shell: Array | None = None) -> Array:
        """Return the nearest interface that encloses the volume: ``FollowingMesh.close_volume``."""
        return self._following.close_volume(points, shell)

    def solve(self, points: Array, motion: InterfaceMotion | None = None) -> Array:
        """p* (F,) [Pa] on the diaphragm's faces, area mean removed, at the step's end.

        A map that changes between two steps takes the patch from one set of facets on the same
        sheet to another. Only the sheet's own ``motion`` drives the liquid.

        Parameters
        ----------
        points
            The interface at the step's end (p, 3) [m], its volume closed.
        motion
            Of the diaphragm at these points, where they slide along it.
        """
        step = self.step
        swept = self._following.follow(points, step.moment)
        step.refuse_open(swept, self.volume, self.settings)
        shape = self._following.now
        walls = self._wall_motion(swept, motion)
        pressure, velocity = self.case.advance(
            step.start, step.end, step.in_case(shape.points), step.in_case(walls.slide)
        )
        on_walls = wall_pressure(self.mesh, shape.geometry, pressure, walls.rate)
        self._solution = FlowSolution.of(
            step, step.in_tank(velocity), self.density * on_walls, walls, shape
        )
        return self._solution.face_pressure

    def _wall_motion(self, swept: Array, motion: InterfaceMotion | None) -> WallMotion:
        """How the walls move whose faces sweep ``swept`` (B,) [m^3] in the step."""
        step, following = self.step, self._following
        rate = self._swept(swept, step.dt, step.previous_dt)
        return wall_motion(
            self.mesh, following.begun, following.now, motion, turn=step.turn,
            dt=step.dt, swept=self._swept.flux, rate=rate, least=NO_SLIDE * self.volume / step.dt,
        )  # fmt: skip

    def liquid_inertia(self, points: Array) -> LiquidInertia:
        """The liquid's inertia in this step, which is expected to end at ``points`` (p, 3) [m]."""
        self._following.follow(points, self.step.moment)
        now = self._following.now
        if self._coarser is not None:
            return LiquidInertia.on(self._coarser, self.mesh, now.points, self.density)
        return LiquidInertia.of(NeumannLaplacian(self.mesh, now.geometry), points, self.density)

    def accept_step(self) -> FlowSample:
        """Commit the last solve."""
        step, solution = self.step, self._solution
        if solution is None:
            raise RuntimeError("flow: solve comes first.")
        self._swept.accept_step()
        self._times.leave(self.time)
        self.time, self._previous_dt = step.end, step.dt
        walls = wall_flow(
            self.mesh, self._following.now.geometry, solution.velocity, solution.walls.velocity,
            viscosity=self.density * self.viscosity, turn=step.turn,
        )  # fmt: skip
        work = 0.5 * step.dt * (self._power + solution.power)
        self._power = solution.power
        self._following.accept_step()
        return flow_sample(
            self.mesh, self._following.geometry,
            density=self.density, velocity=solution.velocity, walls=walls, pressure_work=work,
            boundary_pressure=solution.wall_pressure,
            volume_error=abs(self._following.excess(self.points)) / self.volume,
            continuity_error=self.case.continuity,
        )  # fmt: skip

    def write_fields(self) -> None:
        """Leave U, p*/rho and the points at the committed time in the case's folder."""
        self._times.show(self.time)

    def save(self) -> dict[str, AnyArray]:
        """The committed state with OpenFOAM's own files at this time, as bytes."""
        self._times.keep(self.time)
        saved: dict[str, AnyArray] = {
            "clock": np.array([self.time, self._previous_dt]),
            "initial": self._initial[0],
            "shell": self._initial[1],
            "points": self.mesh_points,
            "swept": self._swept.save(),
            "power": np.array([self._power]),
        }
        return saved | packed(self.case, self.time)

    def close(self) -> None:
        """Leave the committed fields in files, and end the solver; a step may still follow."""
        self._times.close(self.time)

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """The reverse of ``save``; fields of later times are gone, a lost case is written anew."""
        self._place(saved["initial"], saved["shell"])
        if not self.case.exists:
            self.case.create(self.mesh_points, viscosity=self.viscosity)
        self.time, self._previous_dt = saved["clock"].tolist()
        self._following.return_to(saved["points"])
        self._swept.restore(saved["swept"])
        self._power = float(saved["power"][0])
        self._times.return_to(self.time)
        unpack(self.case, self.time, saved)
