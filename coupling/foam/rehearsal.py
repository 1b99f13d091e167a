"""One step of a tiny flow before a run: what keeps OpenFOAM from working here shows at once."""

from __future__ import annotations

import tempfile
from functools import cache
from pathlib import Path

from coupling.finite_volume.mesh import half_ball
from coupling.foam.installation import cause_of, find_openfoam, mend_of
from coupling.foam.keepalive import case_of
from coupling.foam.prefixes import OpenFoamMissing
from coupling.foam.process import OpenFoam, OpenFoamFailed
from coupling.ports import StepFailed

_CELLS = 176
_STEP = 1e-3  # [s]
_TIMEOUT = 60.0  # [s]


@cache
def rehearse(command: str, *, keep_alive: bool, processors: int) -> None:
    """Solve one step of a liquid at rest with the solver that a run would take, in 0.3 s.

    A program that does not start, a library that does not load, an MPI that finds no launcher and
    a full or unwritable temporary folder all fail here. Raises ``OpenFoamMissing`` with the cause
    and the mend.
    """
    openfoam = find_openfoam(command, keep_alive=keep_alive, processors=processors)
    try:
        with tempfile.TemporaryDirectory(prefix="edt-") as folder:
            said = _step(Path(folder) / "case", openfoam)
    except OSError as error:
        raise OpenFoamMissing(
            f"{error.filename or 'TMPDIR'}: {error.strerror or error}. "
            "Set TMPDIR to a folder that can be written and has room."
        ) from error
    if said:
        raise OpenFoamMissing(
            f"{openfoam.keep_alive or openfoam.solver}: does not work here: {cause_of(said)} "
            f"{mend_of(said, openfoam)}"
        )


def _step(folder: Path, openfoam: OpenFoam) -> str:
    """What the solver said of a step that failed; nothing where it did not."""
    mesh = half_ball(_CELLS)
    case = case_of(folder, mesh, openfoam=openfoam, timeout=_TIMEOUT)
    try:
        case.create(mesh.points, viscosity=1e-6)
        case.advance(0.0, _STEP, mesh.points)
    except (OpenFoamFailed, StepFailed) as error:
        said = case.log.read_text(encoding="utf-8", errors="replace") if case.log.is_file() else ""
        return said or str(error).partition(". ")[0].partition(": ")[2]
    finally:
        case.close()
    return ""
