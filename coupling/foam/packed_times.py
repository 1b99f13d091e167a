"""A case's fields at one time as arrays of bytes, for a checkpoint."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from coupling.foam.case import WALL_PRESSURE, Case
from coupling.foam.prefixes import advice, same_version
from coupling.foam.process import OpenFoamFailed
from coupling.ports import AnyArray

_VERSION = "version"  # of the OpenFOAM that computed the fields, as bytes


def packed(case: Case, time: float) -> dict[str, AnyArray]:
    """The files of a ``case`` at ``time`` [s] as bytes, by ``file:`` and their names.

    With them the version of OpenFOAM.
    """
    case.flush(time)
    found: dict[str, AnyArray] = {_VERSION: np.frombuffer(case.openfoam.version.encode(), np.uint8)}
    for part in case.parts:
        folder = part.folder / case.time_name(time)
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                name = (Path(part.name) / path.relative_to(folder)).as_posix()
                found[f"file:{name}"] = np.frombuffer(path.read_bytes(), np.uint8)
    return found


def unpack(case: Case, time: float, saved: Mapping[str, AnyArray]) -> None:
    """The reverse of ``packed``; other entries of ``saved`` are ignored.

    Raises ``OpenFoamFailed`` where they are those of another number of processors or of another
    version of OpenFOAM, or ask for the walls' library where it has not been built.
    """
    _refuse_other_version(case, time, saved)
    named = {name.split("/")[0] for name in saved if name.startswith("file:processor")}
    if max(1, len(named)) != len(case.parts):
        raise OpenFoamFailed(
            f"t = {time:.6g} s: the checkpoint is one of {max(1, len(named))} processors, the "
            f"scene asks for {len(case.parts)}. Set openfoam.processors = {max(1, len(named))}."
        )
    pressures = (bytes(data) for name, data in saved.items() if re.search("[:/]p$", name))
    if case.openfoam.walls is None and any(WALL_PRESSURE.encode() in data for data in pressures):
        raise OpenFoamFailed(
            f"t = {time:.6g} s: the run was begun with the walls' pressure that 'edt "
            "build-solver' builds, which is not there now. Run 'edt build-solver', then resume."
        )
    for part in case.parts:
        head = f"file:{part.name}/" if part.name else "file:"
        for name, data in saved.items():
            if name.startswith(head):
                path = part.folder / case.time_name(time) / name.removeprefix(head)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(data.astype(np.uint8).tobytes())


def _refuse_other_version(case: Case, time: float, saved: Mapping[str, AnyArray]) -> None:
    """Refuse to go on with another OpenFOAM, whose flow would differ; older ``saved`` name none."""
    if _VERSION not in saved:
        return
    began, here = bytes(saved[_VERSION].astype(np.uint8)).decode(), case.openfoam.version
    if not same_version(began, here):
        mend = advice(began.removeprefix("v")) or f"Source the etc/bashrc of version {began} first."
        raise OpenFoamFailed(
            f"t = {time:.6g} s: the run was begun with OpenFOAM {began}, and that of this command "
            f"is {here} in {case.openfoam.project_dir}. {mend}"
        )
