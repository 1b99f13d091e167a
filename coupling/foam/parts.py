"""The folders that OpenFOAM's processes work in: the case's own, or one of each processor.

The case is decomposed once, by OpenFOAM's own program. Which points and cells of the whole mesh a
processor has is read from the files it leaves, so that values go in and out without it.
"""

from __future__ import annotations

import shutil
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from coupling.foam import fields
from coupling.foam.process import OpenFoam, OpenFoamFailed, run_program
from coupling.foam.pyfoam import ParsedParameterFile
from coupling.ports import Array, Ints

_ADDRESSING = "constant/polyMesh/{}ProcAddressing"


@dataclass(frozen=True, kw_only=True)
class Part:
    """What one process has: its ``folder``, and its ``points`` and ``cells`` in the whole mesh.

    ``walls``: its boundary faces among those of the whole mesh, in its own order. ``name`` is that
    of the folder within the case, empty for the case itself.
    """

    name: str
    folder: Path
    points: Ints | slice
    cells: Ints | slice
    walls: Ints | slice


def whole(case: Path) -> list[Part]:
    """The one part of a case that is not decomposed."""
    return [Part(name="", folder=case, points=slice(None), cells=slice(None), walls=slice(None))]


def decompose(case: Path, *, openfoam: OpenFoam, timeout: float) -> None:
    """Spread mesh and fields at the case's start over ``openfoam.processors`` folders.

    Cut by planes: Debian's OpenFOAM comes without scotch, and the parts are then the same whenever
    the case is written anew. Raises ``OpenFoamFailed``.
    """
    settings = ParsedParameterFile(str(case / "system" / "decomposeParDict"))
    settings["numberOfSubdomains"] = openfoam.processors
    settings["hierarchicalCoeffs"]["n"] = f"({' '.join(map(str, cuts(openfoam.processors)))})"
    settings.writeFile()
    program = shutil.which("decomposePar")
    if program is None:
        raise OpenFoamFailed("t = 0 s: the program decomposePar has gone from the PATH.")
    run_program(
        Path(program), case, openfoam=replace(openfoam, processors=1, mpirun=None),
        log=case / "log.decomposePar", timeout=timeout, moment="t = 0 s",
    )  # fmt: skip


def cuts(processors: int) -> tuple[int, int, int]:
    """Three factors of ``processors``, as near to each other as it allows, the largest first."""
    smallest = max(
        k for k in range(1, processors + 1) if k**3 <= processors and processors % k == 0
    )
    rest = processors // smallest
    middle = max(k for k in range(1, rest + 1) if k * k <= rest and rest % k == 0)
    return (rest // middle, middle, smallest)


def is_spread(case: Path, processors: int) -> bool:
    """Whether the case in this folder has been decomposed for so many processors."""
    if processors == 1:
        return True
    folders = sorted(path.name for path in case.glob("processor*"))
    return folders == sorted(f"processor{rank}" for rank in range(processors)) and all(
        (case / name / _ADDRESSING.format("cell")).is_file() for name in folders
    )


def decomposed(case: Path, processors: int, inner_faces: int) -> list[Part]:
    """The parts of a decomposed case, whose whole mesh has so many ``inner_faces``.

    Raises ``OpenFoamFailed`` where one is missing or broken.
    """
    found = []
    for rank in range(processors):
        name = f"processor{rank}"
        folder = case / name
        points, cells, faces = (
            fields.read_labels(folder / _ADDRESSING.format(kind))
            for kind in ("point", "cell", "face")
        )
        walls = np.abs(faces) - 1 - inner_faces  # counted from 1; below 0 where turned round
        part = Part(name=name, folder=folder, points=points, cells=cells, walls=walls[walls >= 0])
        found.append(part)
    return found


def gathered(parts: list[Part], values: list[Array]) -> Array:
    """Values of all cells, (c,) or (c, 3), from those of every part's."""
    if len(parts) == 1:
        return values[0]
    whole_field = np.empty((sum(map(len, values)), *values[0].shape[1:]))
    for part, own in zip(parts, values, strict=True):
        whole_field[part.cells] = own
    return whole_field
