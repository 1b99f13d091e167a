"""A case's fields at one time as arrays of bytes, for a checkpoint."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from coupling.foam.case import WALL_PRESSURE, Case
from coupling.foam.process import OpenFoamFailed
from coupling.ports import AnyArray


def packed(case: Case, time: float) -> dict[str, AnyArray]:
    """The files of a ``case`` at ``time`` [s] as bytes, by ``file:`` and their names."""
    case.flush(time)
    found: dict[str, AnyArray] = {}
    for part in case.parts:
        folder = part.folder / case.time_name(time)
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                name = (Path(part.name) / path.relative_to(folder)).as_posix()
                found[f"file:{name}"] = np.frombuffer(path.read_bytes(), np.uint8)
    return found


def unpack(case: Case, time: float, saved: Mapping[str, AnyArray]) -> None:
    """The reverse of ``packed``; other entries of ``saved`` are ignored.

    Raises ``OpenFoamFailed`` where they are those of another number of processors, or ask for the
    walls' library where it has not been built.
    """
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
