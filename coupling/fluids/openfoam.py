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

from coupling.foam.added_mass import added_mass, wall_distance
from coupling.foam.geometry import (
    CellGeometry,
    cell_geometry,
    fan_volume,
    non_orthogonality,
    swept_volumes,
)
from coupling.foam.keepalive import case_of
from coupling.foam.mesh import LiquidMesh
from coupling.foam.process import OpenFoam
from coupling.foam.smoothing import ElasticMesh, MeshFolds
from coupling.interface import swept_gradient
from coupling.ports import AddedMass, AnyArray, Array, FlowSample, Ints, RunFailed

CLOSURE = 1e-12  # of the liquid's volume: what a solver call may miss, as OpenFOAM sums it


class OpenFoamFlow:
    """The liquid on one of the meshes, in an OpenFOAM case in ``folder``.

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
        self.radius, self.density, self.viscosity = radius, density, viscosity
        self.faces: Ints = mesh.patch_faces
        self._boundary: Ints = mesh.faces[mesh.inner_faces :]
        self._elastic = ElasticMesh(mesh, radius)
        self.time = 0.0
        self._kept: set[float] = {0.0}

    @property
    def moulded_face_centres(self) -> Array:
        """Where the interface's faces lie in the moulded shape (F, 3) [m]."""
        return np.asarray(self.radius * self.mesh.moulded[self.faces].mean(axis=1))

    @property
    def non_orthogonality_max(self) -> float:
        """Largest non-orthogonality [deg] of the committed mesh."""
        return float(non_orthogonality(self.mesh, self._geometry).max())

    def start(self, patch: Array, shell: Array, volume: float) -> None:
        """Write the case for a liquid at rest below ``patch`` (p, 3) [m], its rim on the shell.

        ``shell`` (s, 3) [m] are the shell's other points; a common factor takes them off the
        sphere until the mesh, an inscribed polyhedron, holds the liquid's ``volume`` [m^3].
        """
        self._place(patch, self._raised(shell, patch, volume), volume)
        self.case.create(self._all_points, viscosity=self.viscosity)

    def _place(self, patch: Array, shell: Array, volume: float) -> None:
        """The state of a liquid at rest."""
        self.time, self.steps = 0.0, 0
        self.points = self._initial = patch
        self._shell = shell
        reference = self.radius * self.mesh.points
        self._asked = volume
        self._size = volume / fan_volume(reference[self._boundary])
        self._all_points = self._relaxed(reference, self._outline(patch), "t = 0 s")
        self._geometry = self._checked_geometry(self._all_points, "t = 0 s")
        self.volume = float(self._geometry.volume.sum())
        self._fan = fan_volume(self._all_points[self._boundary])
        count = len(self.faces)
        self._swept = np.zeros(count)
        self._flux = np.zeros((2, count))  # boundary flux [m^3/s] at the last step, the one before

    def _raised(self, shell: Array, patch: Array, volume: float) -> Array:
        factor = 1.0
        for _ in range(20):
            points = np.empty_like(self.mesh.points)
            points[self.mesh.shell_points] = factor * shell
            points[self.mesh.patch_points] = patch
            missing = volume - fan_volume(points[self._boundary])
            if abs(missing) < 1e-12 * volume:
                break
            factor *= 1 + missing / (3 * volume)
        return factor * shell

    def begin_step(self, time: float, dt: float) -> None:
        """Start a step of ``dt`` [s] from the committed fields at ``time`` [s]."""
        self.time, self.dt = round(time, 11), dt  # as the case's folders are named
        self._base: Array | None = None  # the step's mesh; later iterations follow it linearly

    def close_volume(self, points: Array) -> Array:
        """``points`` (p, 3) shifted along their normals until the volume is the start's."""
        for _ in range(30):
            excess = self._excess(points)
            if abs(excess) <= 2e-16 * self.volume:
                break
            normal = np.zeros_like(points)
            np.add.at(normal, self.faces, swept_gradient(points[self.faces]))
            normal[self.mesh.rim] = 0.0
            # A shift of equal height everywhere, so that it does not favour large faces.
            height = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
            points = points - height * excess / float((normal * height).sum())
        return points

    def _excess(self, patch: Array) -> float:
        """Volume [m^3] above the start's, by the sum that OpenFOAM's swept volumes add up to."""
        return fan_volume(self._outline(patch)[self._boundary]) - self._fan

    def _outline(self, patch: Array) -> Array:
        """Points (P, 3) of which those on the boundary stand where they should."""
        points = np.zeros_like(self.mesh.points)
        points[self.mesh.shell_points] = self._shell
        points[self.mesh.patch_points] = patch
        return points

    def _relaxed(self, start: Array, outline: Array, moment: str) -> Array:
        try:
            return self._elastic.relax(start, outline, size=self._size)
        except MeshFolds:
            raise RunFailed(
                f"{moment}: no valid mesh of the liquid was found below the diaphragm. Raise "
                "liquid.fill_fraction (0.25 and more has worked at rest), lower motion.amplitude, "
                "or take model.fluid = 'hydrostatic'."
            ) from None

    def solve(self, points: Array) -> Array:
        """p* (F,) [Pa] on the diaphragm's faces, area mean removed, at the step's end."""
        moment = f"t = {self.time + self.dt:.6g} s"
        all_points = self._meshed(points, moment)
        swept = swept_volumes(self._all_points[self._boundary], all_points[self._boundary])
        self._swept_now = swept[: self.mesh.diaphragm_faces]
        missed = abs(swept.sum()) / self.volume
        if missed > CLOSURE:
            raise RunFailed(
                f"{moment}: the interface changes the liquid's volume by {missed:.1e} of it; "
                "OpenFOAM would answer with a pressure that means nothing. Halve time.step."
            )
        self._now = self._checked_geometry(all_points, moment)
        self._patch_now, self._all_now = points, all_points
        self._pressure, self._velocity = self.case.advance(
            self.time, self.time + self.dt, all_points
        )
        self._pressure = self.density * self._pressure
        wall = self._wall_pressure()
        area = np.linalg.norm(self._now.face_area[self.mesh.diaphragm], axis=1)
        self._level = float(wall @ area / area.sum())
        self._face_pressure = wall - self._level
        return self._face_pressure

    def _wall_pressure(self) -> Array:
        """The cells' p* carried over the half cell to the wall: p - rho d a_n."""
        if self.steps == 0:
            self._flux_now = self._swept_now / self.dt
            rate = (self._flux_now - self._flux[0]) / self.dt
        else:
            self._flux_now = (1.5 * self._swept_now - 0.5 * self._swept) / self.dt
            rate = (1.5 * self._flux_now - 2 * self._flux[0] + 0.5 * self._flux[1]) / self.dt
        patch = self.mesh.diaphragm
        area = np.linalg.norm(self._now.face_area[patch], axis=1)
        distance = wall_distance(self.mesh, self._now)
        return np.asarray(
            self._pressure[self.mesh.owner[patch]] - self.density * distance * rate / area
        )

    def added_mass(self, points: Array) -> AddedMass:
        """The liquid's inertia in this step, which is expected to end at ``points`` (p, 3) [m]."""
        moment = f"t = {self.time + self.dt:.6g} s"
        geometry = self._checked_geometry(self._meshed(points, moment), moment)
        return added_mass(self.mesh, geometry, points, self.density)

    def _meshed(self, points: Array, moment: str) -> Array:
        """The mesh (P, 3) of the step's end at ``points`` (p, 3), linear in it within the step."""
        if self._base is None:
            self._base = self._relaxed(self._all_points, self._outline(points), moment)
        return self._elastic.follow(self._base, self._outline(points))

    def accept_step(self) -> FlowSample:
        """Commit the last solve."""
        self._swept = self._swept_now
        self._flux = np.stack([self._flux_now, self._flux[0]])
        if self.time not in self._kept:
            self.case.remove(self.time)
        self.steps += 1
        self.time = round(self.time + self.dt, 11)
        self.points, self._all_points = self._patch_now, self._all_now
        self._geometry = self._now
        return self._sample()

    def _sample(self) -> FlowSample:
        mesh, geometry = self.mesh, self._geometry
        boundary = slice(mesh.inner_faces, None)
        pressure = self._pressure[mesh.owner[boundary]] - self._level
        pressure[: mesh.diaphragm_faces] = self._face_pressure
        force = pressure[:, None] * geometry.face_area[boundary]
        speed = np.linalg.norm(self._velocity, axis=1)
        wall_speed = speed[mesh.owner[mesh.diaphragm]]
        rate = self._face_pressure / self.density + 0.5 * wall_speed**2
        volume = float(geometry.volume.sum())
        return FlowSample(
            face_pressure=self._face_pressure,
            wall_pressure_force=force.sum(axis=0),
            wall_pressure_moment=np.cross(geometry.face_centre[boundary], force).sum(axis=0),
            speed_max=float(speed.max()),
            dphi_dt_max=float(np.abs(rate).max()),
            kinetic_energy=0.5 * self.density * float(geometry.volume @ speed**2),
            volume=volume,
            volume_error=abs(self._excess(self.points)) / self.volume,
            liquid_cg=geometry.volume @ geometry.centre / volume,
            continuity_error=self.case.continuity,
            non_orthogonality_max=self.non_orthogonality_max,
        )

    def _checked_geometry(self, points: Array, moment: str) -> CellGeometry:
        geometry = cell_geometry(self.mesh, points)
        if not geometry.volume.min() > 0:
            cell = int(np.argmin(geometry.volume))
            place = ", ".join(f"{x:.3f}" for x in geometry.centre[cell])
            raise RunFailed(
                f"{moment}: the flow's mesh has an inverted cell: {cell} near ({place}) m has the "
                f"volume {geometry.volume[cell]:.1e} m^3. Lower motion.amplitude, raise "
                "openfoam.clearance, or take model.fluid = 'hydrostatic'."
            )
        return geometry

    def save(self) -> dict[str, AnyArray]:
        """The committed state with OpenFOAM's own files at this time, as bytes."""
        self._kept.add(self.time)
        saved: dict[str, AnyArray] = {
            "time": np.array([self.time, self.steps]),
            "initial": self._initial,
            "shell": self._shell,
            "volume": np.array([self._asked]),
            "points": self._all_points,
            "swept": self._swept,
            "flux": self._flux,
        }
        return saved | self.case.pack(self.time)

    def close(self) -> None:
        """Leave the committed fields in files, and end the solver; a step may still follow."""
        with suppress(RunFailed):  # then the solver has failed, and the run ended by that
            self.case.flush(self.time)
        self.case.close()

    def restore(self, saved: Mapping[str, AnyArray]) -> None:
        """The reverse of ``save``; fields of later times are gone, a lost case is written anew."""
        self._place(saved["initial"], saved["shell"], float(saved["volume"][0]))
        if not self.case.exists:
            self.case.create(self._all_points, viscosity=self.viscosity)
        self.time, self.steps = float(saved["time"][0]), int(saved["time"][1])
        self._all_points, self._swept, self._flux = saved["points"], saved["swept"], saved["flux"]
        self.points = self._all_points[self.mesh.patch_points]
        self._geometry = cell_geometry(self.mesh, self._all_points)
        self.case.rewind(self.time)
        self._kept = set(self.case.times)
        self.case.unpack(self.time, saved)
