"""Incompressible Navier-Stokes in the moving tank, by OpenFOAM's pimpleFoam.

The flow is solved in the tank's frame without body force: the body force is a gradient, so that
the pressure found is p*, what hydrostatics leaves out. Every coupling iteration solves the step
anew from the committed fields; its points are all imposed.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path

import numpy as np

from coupling.finite_volume.added_mass import NeumannLaplacian, added_mass
from coupling.finite_volume.following import FollowingMesh
from coupling.finite_volume.geometry import CellGeometry
from coupling.finite_volume.gradients import wall_pressure
from coupling.finite_volume.mesh import LiquidMesh
from coupling.finite_volume.rates import FluxRate
from coupling.finite_volume.wall import cell_distance, wall_flow
from coupling.fluids.openfoam.sample import flow_sample
from coupling.foam.keepalive import case_of
from coupling.foam.process import OpenFoam
from coupling.ports import (
    AddedMass,
    AnyArray,
    Array,
    Cause,
    FlowSample,
    Ints,
    RunFailed,
    StepFailed,
)

CLOSURE = 1e-12  # of the liquid's volume: what a solver call may miss, as OpenFOAM sums it


class OpenFoamFlow:
    """The liquid on a mesh, in an OpenFOAM case in ``folder``.

    ``density`` [kg/m^3], ``viscosity`` [m^2/s], ``radius`` [m] of the shell, ``timeout`` [s] of
    one solver call. Nothing is written before ``start`` or ``restore``.
    """

    def __init__(
        self,
        folder: Path,
        mesh: LiquidMesh,
        *,
        openfoam: OpenFoam,
        radius: float,
        density: float,
        viscosity: float,
        timeout: float,
    ) -> None:
        self.mesh = mesh
        self.case = case_of(folder, mesh, openfoam=openfoam, timeout=timeout)
        self.density, self.viscosity = density, viscosity
        self.faces: Ints = mesh.patch_faces
        self._following = FollowingMesh(mesh, radius)
        self.time = 0.0
        self._kept: set[float] = {0.0}
        self._shown: set[float] = set()  # times whose fields somebody asked for

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

    def start(self, patch: Array, shell: Array, volume: float) -> None:
        """Write the case for a liquid at rest below ``patch`` (p, 3) [m], its rim on the shell.

        ``shell`` (s, 3) [m] are the shell's other points; a common factor takes them off the
        sphere until the mesh, an inscribed polyhedron, holds the liquid's ``volume`` [m^3].
        """
        self._place(patch, self._following.raised(shell, patch, volume))
        self.case.create(self.mesh_points, viscosity=self.viscosity)

    def _place(self, patch: Array, shell: Array) -> None:
        """The state of a liquid at rest."""
        self.time, self._previous_dt = 0.0, 0.0  # the latter of the step before, 0 at the start
        self._initial = (patch, shell)
        self._following.place(patch, shell)
        self._moving = FluxRate(len(self.faces))
        self._sliding = FluxRate(len(self.mesh.faces) - self.mesh.inner_faces)
        self._pressure_before = np.zeros(len(self.faces))  # p* on them a step ago [Pa]

    def begin_step(self, time: float, dt: float, shell: Array | None = None) -> None:
        """Start a step of ``dt`` [s] from the committed fields at ``time`` [s].

        ``shell`` (s, 3) [m]: where the shell's points end it, None where they stay.
        """
        # As the case names its folders: the next step starts where this ends, digit for digit.
        self.time, self._end, self.dt = round(time, 11), round(time + dt, 11), dt
        self._moment = f"t = {self._end:.6g} s"
        self._following.begin_step(shell)
        self._laplacian: NeumannLaplacian | None = None  # where the step is expected to end
        self._rate: Array | None = None  # of the fluxes that sliding makes (B,) [m^3/s^2]

    def slide(self, points: Array) -> None:
        """Take ``points`` (p, 3) [m] for where the interface's points, slid along, start the step.

        A map that changes between two steps takes the patch from one set of facets on the same
        sheet to another. The solver sees a motion there and answers with its inertia, which the
        sheet must not feel.
        """
        swept = self._following.slid(points)
        self._rate = self._sliding(swept, self.dt, self._previous_dt)
        self._undue: Array | None = None

    def close_volume(self, points: Array) -> Array:
        """``points`` (p, 3) shifted along their normals until the volume is the start's."""
        return self._following.close_volume(points)

    def solve(self, points: Array) -> Array:
        """p* (F,) [Pa] on the diaphragm's faces, area mean removed, at the step's end."""
        swept = self._following.follow(points, self._moment)
        missed = abs(swept.sum()) / self.volume
        if missed > CLOSURE:
            why = f"the interface changes the liquid's volume by {missed:.1e} of it"
            raise StepFailed(f"{self._moment}: {why}.", cause=Cause.MESH)
        pressure, self._velocity = self.case.advance(
            self.time, self._end, self._following.points_now
        )
        self._swept = swept[: self.mesh.diaphragm_faces]
        rate = self._moving(self._swept, self.dt, self._previous_dt)
        self._boundary_pressure = self._on_walls(pressure, rate)
        self._face_pressure = self._boundary_pressure[: len(rate)]
        return self._face_pressure

    def inertial_pressure(self, points: Array) -> Array:
        """What ``solve``, which comes again before the end, would say of inertia alone (F,)."""
        swept = self._following.follow(points, self._moment)[: self.mesh.diaphragm_faces]
        rate = self._moving(swept, self.dt, self._previous_dt)
        rest = len(self.mesh.faces) - self.mesh.diaphragm.stop
        shell = np.zeros(rest) if self._rate is None else self._rate[-rest:]
        laplacian = NeumannLaplacian(self.mesh, self._now)
        cells = laplacian.pressure(np.concatenate([rate, shell]))
        return self._on_walls(cells, rate)[: len(rate)]

    def _on_walls(self, pressure: Array, rate: Array) -> Array:
        """p* (B,) [Pa] on the walls of the cells' ``pressure`` (c,) [m^2/s^2], over the density.

        ``rate`` (F,) [m^3/s^2]: of the diaphragm's fluxes. What sliding points ask of the pressure
        is taken off.
        """
        if self._rate is not None:
            if self._undue is None:
                laplacian = self._laplacian or NeumannLaplacian(self.mesh, self._now)
                self._undue = laplacian.pressure(self._rate)
            pressure, rate = pressure - self._undue, rate - self._rate[: len(rate)]
        return self.density * wall_pressure(self.mesh, self._now, pressure, rate)

    @property
    def _now(self) -> CellGeometry:
        return self._following.geometry_now

    def added_mass(self, points: Array) -> AddedMass:
        """The liquid's inertia in this step, which is expected to end at ``points`` (p, 3) [m]."""
        self._following.follow(points, self._moment)
        self._laplacian = NeumannLaplacian(self.mesh, self._now)
        return added_mass(self._laplacian, points, self.density)

    def accept_step(self) -> FlowSample:
        """Commit the last solve."""
        self._moving.accept_step()
        if self._rate is not None:
            self._sliding.accept_step()
        if self.time not in self._kept | self._shown:
            self.case.remove(self.time)
        elif self.time not in self._kept:
            self.case.thin(self.time)
        self.time, self._previous_dt = self._end, self.dt
        walls = wall_flow(
            self.mesh, self._following.geometry, self._now, self._velocity,
            dt=self.dt, viscosity=self.density * self.viscosity,
        )  # fmt: skip
        work = 0.5 * float((self._pressure_before + self._face_pressure) @ self._swept)
        self._pressure_before = self._face_pressure
        self._following.accept_step()
        return flow_sample(
            self.mesh, self._following.geometry,
            density=self.density, velocity=self._velocity, walls=walls, pressure_work=work,
            boundary_pressure=self._boundary_pressure,
            volume_error=abs(self._following.excess(self.points)) / self.volume,
            continuity_error=self.case.continuity,
            non_orthogonality_max=self.non_orthogonality_max,
            wall_distance=self.wall_distance,
        )  # fmt: skip

    def write_fields(self) -> None:
        """Leave U, p*/rho and the points at the committed time in the case's folder."""
        self.case.flush(self.time)
        self._shown.add(self.time)

    def save(self) -> dict[str, AnyArray]:
        """The committed state with OpenFOAM's own files at this time, as bytes."""
        self._kept.add(self.time)
        saved: dict[str, AnyArray] = {
            "clock": np.array([self.time, self._previous_dt]),
            "initial": self._initial[0],
            "shell": self._initial[1],
            "points": self.mesh_points,
            "moving": self._moving.save(),
            "sliding": self._sliding.save(),
            "pressure": self._pressure_before,
        }
        return saved | self.case.pack(self.time)

    def close(self) -> None:
        """Leave the committed fields in files, and end the solver; a step may still follow."""
        with suppress(RunFailed):  # then the solver has failed, and the run ended by that
            self.case.flush(self.time)
        self.case.close()

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """The reverse of ``save``; fields of later times are gone, a lost case is written anew."""
        if "clock" not in saved:
            raise RunFailed("checkpoint.h5: an older version wrote it. Run the scene again.")
        self._place(saved["initial"], saved["shell"])
        if not self.case.exists:
            self.case.create(self.mesh_points, viscosity=self.viscosity)
        self.time, self._previous_dt = saved["clock"].tolist()
        self._following.return_to(saved["points"])
        self._moving.restore(saved["moving"])
        self._sliding.restore(saved["sliding"])
        self._pressure_before = saved["pressure"]
        self.case.rewind(self.time)
        self._kept = {*self.case.times, self.time}
        self.case.unpack(self.time, saved)
