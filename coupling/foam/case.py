"""One OpenFOAM case on disk: written from the template, advanced a step at a time, read back.

The folder is an ordinary case: every dictionary is readable, ``checkMesh`` and ParaView open it.
"""

from __future__ import annotations

import re
import shutil
from functools import cached_property
from importlib.resources import as_file, files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from coupling.finite_volume.mesh import LiquidMesh
from coupling.foam import fields
from coupling.foam.logs import read_log
from coupling.foam.parts import Part, decompose, decomposed, is_spread, whole
from coupling.foam.process import OpenFoam, OpenFoamFailed, run_program
from coupling.foam.pyfoam import ParsedParameterFile

if TYPE_CHECKING:
    from coupling.ports import Array

_PATCHES = ("diaphragm", "shell")
WALL_PRESSURE = "acceleratingWallPressure"  # of the walls' library, as is what follows
_SLIDING = "slidingWallVelocity"
_SHOWN = frozenset({"p", "U", "points"})  # what is looked at, of the files of a time
_TIME = re.compile(r"\d+(\.\d+)?(e-\d+)?")


class Case:
    """A case of ``mesh`` in ``folder``, solved by ``openfoam``, restarted for every call.

    ``timeout`` [s] is the wall time one call of the solver may take. One processor only: the stock
    solver is wrong on several.
    """

    solver = "restart"
    uneven_steps = False  # a restarted stock solver takes the step before for as long as its own

    def __init__(
        self, folder: Path, mesh: LiquidMesh, *, openfoam: OpenFoam, timeout: float
    ) -> None:
        self.folder = folder.resolve()
        self.mesh = mesh
        self.openfoam = openfoam
        self.timeout = timeout

    @property
    def log(self) -> Path:
        """The last solver call's output."""
        return self.folder / f"log.{self.openfoam.solver.name}"

    @cached_property
    def parts(self) -> list[Part]:
        """The folders that hold the fields, one a processor."""
        if self.openfoam.processors == 1:
            return whole(self.folder)
        return decomposed(self.folder, self.openfoam.processors, self.mesh.inner_faces)

    def create(self, points: Array, *, viscosity: float) -> None:
        """Write the whole case anew: mesh at ``points`` (P, 3) [m], liquid at rest."""
        self.close()
        if self.folder.exists():
            shutil.rmtree(self.folder)
        with as_file(files("foam_cases") / "template") as template:
            shutil.copytree(template, self.folder, ignore=shutil.ignore_patterns("README*"))
        shutil.copytree(self.folder / "0.orig", self.folder / "0")
        (self.folder / "case.foam").touch()  # ParaView's handle
        transport = ParsedParameterFile(str(self.folder / "constant" / "transportProperties"))
        transport["nu"] = viscosity
        transport.writeFile()
        if self.openfoam.walls is not None:
            self._take_walls()
        self._write_step(0.0, 1.0)  # for OpenFOAM's own programs, before the first step
        self._write_mesh(points)
        self.__dict__.pop("parts", None)
        if self.openfoam.processors > 1:
            decompose(self.folder, openfoam=self.openfoam, timeout=self.timeout)

    def _take_walls(self) -> None:
        """Take the conditions of an accelerating, sliding wall, from the library built."""
        for name, kind in (("p", WALL_PRESSURE), ("U", _SLIDING)):
            field = ParsedParameterFile(str(self.folder / "0" / name))
            for patch in _PATCHES:
                field["boundaryField"][patch]["type"] = kind
            field.writeFile()

    def _write_mesh(self, points: Array) -> None:
        mesh, folder = self.mesh, self.folder / "constant" / "polyMesh"
        folder.mkdir()
        fields.write_points(folder / "points", points)
        fields.write_faces(folder / "faces", mesh.faces)
        note = (
            f"nPoints:{len(mesh.points)} nCells:{mesh.cells} "
            f"nFaces:{len(mesh.faces)} nInternalFaces:{mesh.inner_faces}"
        )
        fields.write_labels(folder / "owner", mesh.owner, note)
        fields.write_labels(folder / "neighbour", mesh.neighbour, note)
        entries = "".join(
            f"    {name} {{ type wall; nFaces {faces.stop - faces.start}; "
            f"startFace {faces.start}; }}\n"
            for name, faces in zip(_PATCHES, (mesh.diaphragm, mesh.shell), strict=True)
        )
        head = fields.header("polyBoundaryMesh", "boundary", "constant/polyMesh", binary=False)
        (folder / "boundary").write_text(
            f"{head}{len(_PATCHES)}\n(\n{entries})\n", encoding="utf-8"
        )

    def advance(
        self, start: float, end: float, points: Array, slide: Array | None = None
    ) -> tuple[Array, Array]:
        """Solve a step; the fields at its start stay, so that the call can be repeated.

        Parameters
        ----------
        start, end
            When the step starts and ends [s].
        points
            Where all points end it (P, 3) [m].
        slide
            What the points of the boundary's faces move more than the walls do (B, 3) [m/s], None
            where they move as the walls.

        Returns
        -------
        pressure : Array
            p*/rho of the cells (c,) [m^2/s^2] at ``end``.
        velocity : Array
            U of the cells (c, 3) [m/s] there.

        Raises
        ------
        OpenFoamFailed
            The solver fails, or cannot take a step of this length, or points that slide.
        """
        self._refuse_uneven(start, end)
        self._write_slide(self.slide_of(slide), f"t = {end:.6g} s")
        origin, result = self.time_folder(start) / "polyMesh", self.time_folder(end)
        origin.mkdir(exist_ok=True)
        fields.write_points(origin / "points0", points)
        self._write_step(start, end)
        self.remove(end)
        run_program(
            self.openfoam.solver, self.folder, openfoam=self.openfoam, log=self.log,
            timeout=self.timeout, moment=f"t = {end:.6g} s",
        )  # fmt: skip
        cells = self.mesh.cells
        return fields.read_cells(result / "p", cells), fields.read_cells(result / "U", cells)

    def slide_of(self, slide: Array | None) -> Array:
        """``slide`` (B, 3) [m/s], 0 where it is None."""
        walls = len(self.mesh.faces) - self.mesh.inner_faces
        return np.zeros((walls, 3)) if slide is None else slide

    def _write_slide(self, slide: Array, moment: str) -> None:
        """Leave ``slide`` (B, 3) [m/s] where the walls' library looks for it."""
        if self.openfoam.walls is not None:
            cut = np.split(slide, [self.mesh.diaphragm_faces])
            for patch, own in zip(_PATCHES, cut, strict=True):
                fields.write_points(self.folder / "constant" / f"slide.{patch}", own)
        elif slide.any():
            raise OpenFoamFailed(
                f"{moment}: points that slide along the diaphragm need the walls' library, which "
                "has not been built. Run 'edt build-solver'."
            )

    def _refuse_uneven(self, start: float, end: float) -> None:
        known = self.time_folder(start) / "uniform" / "time"
        said = known.read_text(encoding="utf-8") if known.is_file() else ""
        last = re.search(r"deltaT\s+(\S+);", said)
        if last is not None and abs(float(last[1]) / (end - start) - 1.0) > 1e-6:
            raise OpenFoamFailed(
                f"t = {end:.6g} s: the step before was one of {last[1]} s, and a restarted "
                f"{self.openfoam.solver.name} goes on by the same only. Run 'edt build-solver', "
                "set openfoam.keep_alive = true, then resume."
            )

    def _write_step(self, start: float, end: float) -> None:
        walls = self.openfoam.walls
        (self.folder / "system" / "step").write_text(
            "// Written by the coupler before every start of the solver.\n"
            f"startTime           {start:.12g};\n"
            f"endTime             {end:.12g};\n"
            f"deltaT              {end - start:.12g};\n"
            + ("" if walls is None else f'libs                ("{walls.name}");\n')
        )

    @property
    def continuity(self) -> float:
        """What the last fluxes miss of the cells' volumes; NaN where the log does not say."""
        said = read_log(self.log)
        return float("nan") if said is None else said.continuity

    def flush(self, time: float) -> None:
        """Leave the fields at ``time`` [s] in files; here they always are."""

    def close(self) -> None:
        """End what runs of the solver; the next step starts from the files. Here nothing does."""

    @staticmethod
    def time_name(time: float) -> str:
        """Name of the folder of the fields at ``time`` [s], as OpenFOAM has it."""
        return f"{round(time, 11):.12g}"

    def time_folder(self, time: float) -> Path:
        """Folder of the fields at ``time`` [s] of a case that is not decomposed."""
        return self.folder / self.time_name(time)

    @property
    def exists(self) -> bool:
        """Whether the case has been written, for as many processors."""
        mesh = self.folder / "constant" / "polyMesh" / "boundary"
        return mesh.is_file() and is_spread(self.folder, self.openfoam.processors)

    @property
    def times(self) -> list[float]:
        """Times [s] that have a folder of fields, in order."""
        names = (path.name for path in self.parts[0].folder.iterdir() if path.is_dir())
        return sorted(float(name) for name in names if _TIME.fullmatch(name))

    def rewind(self, time: float) -> None:
        """Forget the fields from ``time`` [s] on; those at 0 stay."""
        self.close()
        for later in self.times:
            if later > time - 1e-11:
                self.remove(later)

    def remove(self, time: float) -> None:
        """Forget the fields at ``time`` [s]; those at 0 stay, the liquid at rest."""
        if time > 0:
            for part in self.parts:
                shutil.rmtree(part.folder / self.time_name(time), ignore_errors=True)

    def thin(self, time: float) -> None:
        """Of the fields at ``time`` [s], keep U, p and the points alone: no step starts there."""
        for part in self.parts:
            for path in list((part.folder / self.time_name(time)).rglob("*")):
                if path.is_file() and path.name not in _SHOWN:
                    path.unlink()

    @property
    def size(self) -> int:
        """Bytes on disk of the fields at all times but 0."""
        folders = [p.folder / self.time_name(t) for p in self.parts for t in self.times if t > 0]
        files = (path for folder in folders for path in folder.rglob("*") if path.is_file())
        return sum(path.stat().st_size for path in files)
