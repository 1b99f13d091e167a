"""One OpenFOAM case on disk: written from the template, advanced a step at a time, read back.

The folder is an ordinary case: every dictionary is readable, ``checkMesh`` and ParaView open it.
"""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping
from importlib.resources import as_file, files
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from PyFoam.RunDictionary.ParsedParameterFile import ParsedParameterFile

from coupling.foam import fields
from coupling.foam.mesh import LiquidMesh
from coupling.foam.process import OpenFoam, run_program

if TYPE_CHECKING:
    from coupling.ports import Array

_PATCHES = ("diaphragm", "shell")
_TIME = re.compile(r"\d+(\.\d+)?(e-\d+)?")


class Case:
    """A case of ``mesh`` in ``folder``, solved by ``openfoam``.

    ``timeout`` [s] is the wall time one call of the solver may take.
    """

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

    def create(self, points: Array, *, viscosity: float) -> None:
        """Write the whole case anew: mesh at ``points`` (P, 3) [m], liquid at rest."""
        if self.folder.exists():
            shutil.rmtree(self.folder)
        with as_file(files("foam_cases") / "template") as template:
            shutil.copytree(template, self.folder, ignore=shutil.ignore_patterns("README*"))
        shutil.copytree(self.folder / "0.orig", self.folder / "0")
        (self.folder / "case.foam").touch()  # ParaView's handle
        transport = ParsedParameterFile(str(self.folder / "constant" / "transportProperties"))
        transport["nu"] = viscosity
        transport.writeFile()
        self._write_mesh(points)

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
        (folder / "boundary").write_text(f"{head}{len(_PATCHES)}\n(\n{entries})\n")

    def advance(self, start: float, end: float, points: Array) -> tuple[Array, Array]:
        """Solve from ``start`` to ``end`` [s] with all points ending at ``points`` (P, 3) [m].

        Returns p*/rho (c,) [m^2/s^2] and U (c, 3) [m/s] of the cells at ``end``. The fields at
        ``start`` stay: the call can be repeated. Raises ``OpenFoamFailed``.
        """
        origin = self.time_folder(start) / "polyMesh"
        origin.mkdir(exist_ok=True)
        fields.write_points(origin / "points0", points)
        (self.folder / "system" / "step").write_text(
            "// Written by the coupler before every call of the solver.\n"
            f"startTime           {start:.12g};\n"
            f"endTime             {end:.12g};\n"
            f"deltaT              {end - start:.12g};\n"
        )
        result = self.time_folder(end)
        if result.exists():
            shutil.rmtree(result)
        run_program(
            self.openfoam.solver, self.folder, openfoam=self.openfoam, log=self.log,
            timeout=self.timeout, moment=f"t = {end:.6g} s",
        )  # fmt: skip
        cells = self.mesh.cells
        return fields.read_cells(result / "p", cells), fields.read_cells(result / "U", cells)

    def time_folder(self, time: float) -> Path:
        """Folder of the fields at ``time`` [s], named as OpenFOAM names it."""
        return self.folder / f"{round(time, 11):.12g}"

    @property
    def exists(self) -> bool:
        """Whether the case has been written."""
        return (self.folder / "constant" / "polyMesh" / "boundary").is_file()

    @property
    def times(self) -> list[float]:
        """Times [s] that have a folder of fields, in order."""
        names = (path.name for path in self.folder.iterdir() if path.is_dir())
        return sorted(float(name) for name in names if _TIME.fullmatch(name))

    def rewind(self, time: float) -> None:
        """Forget the fields from ``time`` [s] on; those at 0 stay."""
        for later in self.times:
            if later > time - 1e-11:
                self.remove(later)

    def remove(self, time: float) -> None:
        """Forget the fields at ``time`` [s]; those at 0 stay, the liquid at rest."""
        if time > 0:
            shutil.rmtree(self.time_folder(time), ignore_errors=True)

    def pack(self, time: float) -> dict[str, NDArray[np.uint8]]:
        """The files of the fields at ``time`` [s] as bytes, by ``file:`` and their names."""
        folder = self.time_folder(time)
        return {
            f"file:{path.relative_to(folder).as_posix()}": np.frombuffer(
                path.read_bytes(), np.uint8
            )
            for path in sorted(folder.rglob("*"))
            if path.is_file()
        }

    def unpack(self, time: float, saved: Mapping[str, NDArray[Any]]) -> None:
        """The reverse of ``pack``; other entries of ``saved`` are let be."""
        folder = self.time_folder(time)
        for name, data in saved.items():
            if name.startswith("file:"):
                path = folder / name.removeprefix("file:")
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data.astype(np.uint8).tobytes())
